// Leaves of every species: outlines, sprays, meshes made of them, sizes, and how they stand on shoots.
#include "tests/unit/trees/growth_shape.h"
#include "trees/growth.h"
#include "trees/growth/leaf_image.h"
#include "trees/growth/leaf_optics.h"
#include "trees/growth/leaf_shape.h"
#include "trees/growth/leaves.h"
#include "trees/growth/triangulate_polygon.h"
#include "trees/patches.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace kokage {
namespace {

constexpr LeafKind blades[] = {LeafKind::oak,    LeafKind::beech, LeafKind::birch, LeafKind::maple,
                               LeafKind::willow, LeafKind::aspen, LeafKind::cherry};

std::string name_of(LeafKind kind) {
    return leaf_kind_names()[std::size_t(kind)];
}

double cross(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

/// Segments that share no end: do they meet? (By signs of areas; touching counts.)
bool meet(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, glm::dvec2 d) {
    const double s = cross(b - a, c - a), t = cross(b - a, d - a), u = cross(d - c, a - c), v = cross(d - c, b - c);
    return s * t <= 0 && u * v <= 0;
}

/// Both halves as one polygon.
std::vector<glm::vec2> whole(const HalfOutline& half) {
    std::vector<glm::vec2> corners(half.begin(), half.end());
    for (std::size_t i = half.size() - 1; i-- > 1;)
        corners.push_back({-half[i].x, half[i].y});
    return corners;
}

TEST(LeafOutline, IsASimplePolygonInItsUnitSquareAtEveryDetail) {
    for (const LeafKind kind : blades)
        for (int detail = 0; detail <= 3; ++detail) {
            const HalfOutline& half = half_outline(kind, detail);
            ASSERT_GE(half.size(), 3u);
            EXPECT_EQ(half.front().x, 0.f);
            EXPECT_LT(half.front().y, 0.2f);
            EXPECT_EQ(half.back(), glm::vec2(0, 1));
            float widest = 0;
            for (std::size_t i = 1; i + 1 < half.size(); ++i) {
                EXPECT_GT(half[i].x, 0.f) << name_of(kind) << ": only the ends touch the midrib";
                EXPECT_GE(half[i].y, 0.f);
                EXPECT_LE(half[i].y, 1.f);
                widest = std::max(widest, half[i].x);
            }
            EXPECT_LE(widest, 0.5f);
            EXPECT_GT(widest, 0.46f) << name_of(kind) << ", detail " << detail << ": as wide as it says";
            const std::vector<glm::vec2> polygon = whole(half);
            const std::size_t n = polygon.size();
            for (std::size_t i = 0; i < n; ++i)
                for (std::size_t j = i + 2; j < n; ++j) {
                    const bool neighbours = (j + 1) % n == i;
                    ASSERT_FALSE(!neighbours && meet(polygon[i], polygon[i + 1], polygon[j], polygon[(j + 1) % n]))
                        << name_of(kind) << ", detail " << detail << ": edges " << i << " and " << j;
                }
        }
}

// Leaf area over length x width: 0.39 for deeply lobed leaves to 0.79 for rounded ones, about 2/3 for most (Schrader et
// al. 2021, Annals of Botany 128:395; Shi et al. 2019, Forests 10:178: 1/2 for triangles, pi/4 for ellipses).
TEST(LeafOutline, CoversAsMuchOfItsSquareAsLeavesOfItsShapeDo) {
    const std::pair<LeafKind, std::pair<double, double>> shares[] = {
        {LeafKind::oak, {0.42, 0.58}},   {LeafKind::beech, {0.62, 0.72}},  {LeafKind::birch, {0.50, 0.62}},
        {LeafKind::maple, {0.39, 0.55}}, {LeafKind::willow, {0.56, 0.70}}, {LeafKind::aspen, {0.66, 0.79}},
        {LeafKind::cherry, {0.54, 0.68}}};
    for (const auto& [kind, range] : shares) {
        const double area = outline_area(mask_outline(kind));
        EXPECT_GT(area, range.first) << name_of(kind);
        EXPECT_LT(area, range.second) << name_of(kind);
        EXPECT_NEAR(outline_area(half_outline(kind, 2)), area, 0.05) << name_of(kind);
        EXPECT_NEAR(outline_area(half_outline(kind, 1)), area, 0.10) << name_of(kind);
    }
}

TEST(LeafOutline, SpeciesAreToldApartByTheirOutlines) {
    const auto width_at = [](LeafKind kind, float y) { // of the right half, of its widest
        float widest = 0;
        const HalfOutline& half = mask_outline(kind);
        for (std::size_t i = 0; i + 1 < half.size(); ++i)
            if ((half[i].y <= y) != (half[i + 1].y <= y))
                widest =
                    std::max(widest, glm::mix(half[i].x, half[i + 1].x, (y - half[i].y) / (half[i + 1].y - half[i].y)));
        return widest;
    };
    EXPECT_GT(width_at(LeafKind::birch, 0.2f), 2.5f * width_at(LeafKind::birch, 0.75f)) << "triangular";
    EXPECT_GT(width_at(LeafKind::oak, 0.7f), 1.25f * width_at(LeafKind::oak, 0.3f)) << "obovate";
    EXPECT_GT(width_at(LeafKind::aspen, 0.85f), 0.2f) << "round";
    EXPECT_LT(width_at(LeafKind::cherry, 0.9f), 0.15f) << "drawn out";
    int crossings = 0;
    const HalfOutline& maple = mask_outline(LeafKind::maple);
    for (std::size_t i = 0; i + 1 < maple.size(); ++i)
        crossings += (maple[i].y <= 0.6f) != (maple[i + 1].y <= 0.6f);
    EXPECT_GE(crossings, 3) << "a side lobe stands beside the middle one";
}

TEST(TriangulatePolygon, KeepsAreaAndOrientation) {
    for (const LeafKind kind : blades)
        for (int detail = 0; detail <= 3; ++detail) {
            const std::vector<glm::vec2> polygon = whole(half_outline(kind, detail));
            const std::vector<glm::uvec3> triangles = triangulate_polygon(polygon);
            EXPECT_EQ(triangles.size(), polygon.size() - 2);
            double area = 0;
            for (const glm::uvec3& t : triangles) {
                const double own = 0.5 * cross(glm::dvec2(polygon[t.y]) - glm::dvec2(polygon[t.x]),
                                               glm::dvec2(polygon[t.z]) - glm::dvec2(polygon[t.x]));
                EXPECT_GT(own, 0);
                area += own;
            }
            EXPECT_NEAR(area, outline_area(half_outline(kind, detail)), 1e-6);
        }
    const std::vector<glm::vec2> clockwise = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
    EXPECT_THROW(triangulate_polygon(clockwise), std::logic_error);
}

void expect_sound(const LeafShape& shape, const std::string& where) {
    ASSERT_EQ(shape.normals.size(), shape.positions.size()) << where;
    ASSERT_EQ(shape.uvs.size(), shape.positions.size()) << where;
    double area = 0;
    for (const glm::uvec3& t : shape.triangles) {
        ASSERT_LT(std::max({t.x, t.y, t.z}), shape.positions.size());
        const glm::dvec3 a(shape.positions[t.x]), b(shape.positions[t.y]), c(shape.positions[t.z]);
        const glm::dvec3 normal = glm::cross(b - a, c - a);
        EXPECT_GT(glm::length(normal), 0) << where;
        for (int k = 0; k < 3; ++k)
            EXPECT_GT(glm::dot(normal, glm::dvec3(shape.normals[t[k]])), 0)
                << where << ": normals look where the front does";
        area += 0.5 * glm::length(normal);
    }
    EXPECT_GT(shape.area, 0);
    EXPECT_LE(shape.area, area * (1 + 1e-9)) << where;
    for (const glm::vec3& normal : shape.normals)
        EXPECT_NEAR(glm::length(normal), 1, 1e-4) << where;
    for (const glm::vec2& uv : shape.uvs) {
        EXPECT_GE(std::min(uv.x, uv.y), -1e-6f) << where;
        EXPECT_LE(std::max(uv.x, uv.y), 1 + 1e-6f) << where;
    }
}

TEST(LeafShape, OfEverySpeciesIsSoundAtEveryDetailFormAndSeason) {
    for (const Species& species : all_species())
        for (const LeafForm form : {LeafForm::outline, LeafForm::alpha})
            for (int detail = 0; detail <= 2; ++detail)
                for (const Season season : {Season::summer, Season::blossom}) {
                    GrowthParameters p = species.parameters;
                    p.leaf_form = form;
                    p.leaf_detail = detail;
                    p.season = season;
                    expect_sound(leaf_shape(p), species.name + ", detail " + std::to_string(detail));
                }
}

TEST(LeafShape, TrianglesAreFew) {
    for (const Species& species : all_species()) {
        GrowthParameters p = species.parameters;
        p.leaf_form = LeafForm::outline;
        p.petiole_length = 0;
        if (has_needles(p.leaf_shape))
            continue;
        const std::size_t most[] = {2, 14, 54}, least[] = {2, 8, 26};
        for (int detail = 0; detail <= 2; ++detail) {
            p.leaf_detail = detail;
            const std::size_t count = leaf_shape(p).triangles.size();
            EXPECT_LE(count, most[detail]) << species.name << ", detail " << detail;
            EXPECT_GE(count, least[detail]) << species.name << ", detail " << detail;
        }
    }
    GrowthParameters card = find_species("spruce").parameters;
    EXPECT_EQ(leaf_shape(card).triangles.size(), 2u) << "one card";
}

TEST(LeafShape, BendLowersTheTipAndKeepsTheMidribsLength) {
    GrowthParameters p = find_species("beech").parameters;
    p.leaf_detail = 2;
    p.leaf_fold = 0;
    p.petiole_length = 0;
    for (const double bend : {0.0, 30.0, 90.0, 180.0}) {
        p.leaf_bend = bend;
        const LeafShape shape = leaf_shape(p);
        const auto tip = std::min_element(shape.uvs.begin(), shape.uvs.end(),
                                          [](const glm::vec2& a, const glm::vec2& b) { return a.y < b.y; }) -
                         shape.uvs.begin();
        // An arc of length 1 that turns by the bend: its chord is 2 sin(bend / 2) / bend, half the bend below the base.
        const double turn = bend * kPiDouble / 180, chord = bend > 0 ? 2 * std::sin(turn / 2) / turn : 1;
        EXPECT_NEAR(shape.positions[std::size_t(tip)].y, chord * std::cos(turn / 2), 1e-5) << bend;
        EXPECT_NEAR(shape.positions[std::size_t(tip)].z, -chord * std::sin(turn / 2), 1e-5) << bend;
    }
}

TEST(LeafShape, PetioleHoldsTheBladeOffAndIsDrawnWhereItIsLong) {
    GrowthParameters p = find_species("aspen").parameters;
    p.leaf_bend = p.leaf_fold = 0;
    const auto lowest_of = [](const LeafShape& shape) {
        float lowest = 1e9f, highest = -1e9f;
        for (const glm::vec3& position : shape.positions) {
            lowest = std::min(lowest, position.y);
            highest = std::max(highest, position.y);
        }
        return std::pair(lowest, highest);
    };
    p.petiole_length = 1;
    const LeafShape with = leaf_shape(p);
    EXPECT_NEAR(lowest_of(with).first, 0, 1e-6) << "from the shoot";
    EXPECT_NEAR(lowest_of(with).second, 2, 1e-6) << "to a blade's length beyond";
    p.petiole_length = 0.08;
    const LeafShape without = leaf_shape(p);
    EXPECT_NEAR(lowest_of(without).first, 0.08, 1e-6) << "too short to be drawn";
    EXPECT_EQ(with.triangles.size(), without.triangles.size() + 2);
    EXPECT_NEAR(with.area - without.area, 0.0015 / p.leaf_length, 1e-6) << "1.5 mm wide";
}

TEST(LeafShape, AreaOfAlphaCardsIsWhatTheirMaskLeaves) {
    for (const Species& species : all_species()) {
        GrowthParameters p = species.parameters;
        p.leaf_form = LeafForm::alpha;
        p.leaves = 60;
        const Tree tree = grow(p);
        const PatchScene scene = make_patches(tree);
        const std::vector<double> areas = solid_areas(scene);
        double shown = 0;
        for (std::size_t i = 0; i < scene.leaf_count; ++i)
            shown += areas[i];
        // Lengths vary by up to a fifth, so the mean of 60 areas by some 3 %.
        EXPECT_NEAR(shown / 60, mean_leaf_area(p), 0.08 * mean_leaf_area(p)) << species.name;
    }
}

TEST(LeafShape, CardsShowTheAreaOfTheOutline) {
    for (const LeafKind kind : blades) {
        GrowthParameters p;
        p.leaf_shape = kind;
        EXPECT_NEAR(solid_share(*leaf_mask(p), mask_cutoff), outline_area(mask_outline(kind)), 0.012) << name_of(kind);
    }
}

TEST(Sprays, HaveTheNeedlesThatWereAskedForInsideTheirBox) {
    for (const float width : {0.3f, 0.8f, 1.5f})
        for (const int needles : {4, 37, 120, 400}) {
            const Spray sprays[] = {pine_spray(needles, width), spruce_spray(needles, width),
                                    cypress_spray(needles, width)};
            for (const Spray& spray : sprays)
                for (const SpraySegment& segment : spray.segments) {
                    EXPECT_LE(std::max(std::abs(segment.tip.x), std::abs(segment.tip.z)), 0.5f * width + 1e-5f);
                    EXPECT_LE(segment.tip.y, 1 + 1e-5f);
                    EXPECT_GE(segment.tip.y, -1e-5f);
                    EXPECT_GT(glm::distance(segment.tip, segment.base), 0);
                    EXPECT_NEAR(glm::dot(segment.across, segment.tip - segment.base), 0, 1e-4);
                }
            const auto needle_count = [](const Spray& spray) {
                return std::count_if(spray.segments.begin(), spray.segments.end(),
                                     [](const SpraySegment& s) { return !s.is_wood; });
            };
            EXPECT_NEAR(double(needle_count(sprays[0])), needles, 3) << "pairs, halved between the planes";
            EXPECT_NEAR(double(needle_count(sprays[1])), needles, 1);
        }
}

// Blade lengths: oak 7-14 cm, beech 4-10 cm, birch 3-7 cm, Norway maple 5-15 cm (wider than long), weeping willow 6-14
// cm and 4-8 times as long as wide, aspen 3-8 cm on petioles of 3-6 cm (Stace 2010, New Flora of the British Isles;
// European Atlas of Forest Tree Species 2016); cherry 5-12 cm (Flora of China 9). Needles: Scots pine 3-7 cm, Norway
// spruce 10-25 mm, 1-1.5 mm wide (Farjon 2010, A Handbook of the World's Conifers).
TEST(LeafSizes, LieInTheirSpeciesRanges) {
    const auto of = [](const char* name) { return find_species(name).parameters; };
    const auto expect_length = [&](const char* name, double low, double high) {
        const GrowthParameters p = of(name);
        EXPECT_GE(p.leaf_length, low) << name;
        EXPECT_LE(p.leaf_length, high) << name;
        EXPECT_EQ(leaf_kind_names()[std::size_t(p.leaf_shape)], name);
    };
    expect_length("oak", 0.07, 0.14);
    expect_length("beech", 0.04, 0.10);
    expect_length("birch", 0.03, 0.07);
    expect_length("maple", 0.05, 0.15);
    expect_length("willow", 0.06, 0.14);
    expect_length("aspen", 0.03, 0.08);
    expect_length("cherry", 0.05, 0.12);
    EXPECT_GE(of("maple").leaf_width, 1.0);
    EXPECT_GE(1 / of("willow").leaf_width, 4);
    EXPECT_LE(1 / of("willow").leaf_width, 8);
    EXPECT_GE(of("aspen").petiole_length * of("aspen").leaf_length, 0.03);
    EXPECT_LE(of("aspen").petiole_length * of("aspen").leaf_length, 0.06);
    const auto needle_length = [&](const char* name) {
        return double(longest_needle(*leaf_spray(of(name)))) * of(name).leaf_length;
    };
    EXPECT_GE(needle_length("pine"), 0.03);
    EXPECT_LE(needle_length("pine"), 0.07);
    EXPECT_GE(needle_length("spruce"), 0.010);
    EXPECT_LE(needle_length("spruce"), 0.025);
    const Spray spruce = leaf_spray(of("spruce")).value();
    for (const SpraySegment& segment : spruce.segments) {
        if (segment.is_wood)
            continue;
        EXPECT_NEAR(2000 * double(segment.half_width) * of("spruce").leaf_length, 1.25, 0.35) << "mm wide";
    }
}

TEST(Phyllotaxis, StandsAsItsNameSays) {
    const auto turn = [](LeafArrangement a, std::uint32_t i, std::uint32_t j) { // in full turns, 0..1
        const double t = (leaf_azimuth(a, j) - leaf_azimuth(a, i)) / (2 * kPiDouble);
        return t - std::floor(t + 1e-6);
    };
    for (std::uint32_t j = 0; j < 20; ++j) {
        EXPECT_NEAR(turn(LeafArrangement::spiral, j, j + 1), 0.4, 1e-4);
        EXPECT_NEAR(turn(LeafArrangement::spiral, j, j + 5), 0, 1e-4) << "the sixth stands over the first";
        EXPECT_NEAR(turn(LeafArrangement::distichous, j, j + 1), 0.5, 1e-4);
        EXPECT_EQ(leaf_node(LeafArrangement::spiral, j), j);
        EXPECT_EQ(leaf_node(LeafArrangement::opposite, j), j / 2);
        EXPECT_EQ(leaf_node(LeafArrangement::whorled, j), j / 5);
    }
    EXPECT_NEAR(turn(LeafArrangement::opposite, 0, 1), 0.5, 1e-4);
    EXPECT_NEAR(turn(LeafArrangement::opposite, 0, 2), 0.25, 1e-4) << "pairs are crossed";
    EXPECT_NEAR(turn(LeafArrangement::whorled, 0, 1), 0.2, 1e-4);
    EXPECT_NEAR(turn(LeafArrangement::whorled, 0, 5), 0.1, 1e-4);
}

TEST(Phyllotaxis, OppositeLeavesShareTheirNodeOnTheTree) {
    GrowthParameters p = find_species("maple").parameters;
    p.leaves = 1200;
    p.leaf_detail = 0;
    p.petiole_length = p.leaf_hang = 0;
    const Tree tree = grow(p);
    const std::size_t corners = tree.parts[1].positions.size() / tree.leaves.size();
    // The blade's foot is where the leaf stands: the vertex at the middle of the base.
    std::size_t paired = 0, lonely = 0;
    for (std::size_t leaf = 0; leaf + 1 < tree.leaves.size(); ++leaf) {
        if (tree.leaves[leaf].branch != tree.leaves[leaf + 1].branch)
            continue;
        const float apart =
            glm::distance(tree.parts[1].positions[leaf * corners], tree.parts[1].positions[(leaf + 1) * corners]);
        (apart < 1e-5f ? paired : lonely)++;
    }
    EXPECT_GT(double(paired), 0.35 * double(paired + lonely));
    EXPECT_GT(paired, 300u);
}

TEST(Leaves, AndWoodStayAboveTheGround) {
    for (const Species& species : all_species())
        for (const int leaves : {10, 60, 500, 4000}) {
            GrowthParameters p = species.parameters;
            p.leaves = leaves;
            const Tree tree = grow(p);
            float wood = 0, lowest = 0;
            for (const Branch& branch : tree.skeleton.branches)
                for (const Branch::Node& node : branch.nodes)
                    wood = std::min(wood, node.position.y);
            for (const glm::vec3& position : tree.parts[1].positions)
                lowest = std::min(lowest, position.y);
            EXPECT_EQ(wood, 0.f) << species.name << ", " << leaves << " leaves";
            // Leaves lie on the ground by their midrib: their sides may dip into it.
            EXPECT_GT(lowest, -0.4 * p.leaf_length) << species.name << ", " << leaves << " leaves";
        }
}

TEST(LeafOptics, ConserveEnergyAndAreOrderedAsMeasured) {
    for (std::size_t k = 0; k < leaf_kind_names().size(); ++k)
        for (const Season season : {Season::spring, Season::summer, Season::autumn, Season::winter, Season::blossom}) {
            const LeafOptics optics = leaf_optics(LeafKind(k), season);
            for (int c = 0; c < 3; ++c) {
                EXPECT_GT(optics.reflectance[c], 0);
                EXPECT_GT(optics.transmittance[c], 0);
                EXPECT_LE(optics.reflectance[c] + optics.transmittance[c], 1);
            }
            if (season == Season::summer) {
                EXPECT_GT(optics.reflectance.g, optics.reflectance.r) << "leaves are green";
                EXPECT_GT(optics.reflectance.r, optics.reflectance.b);
            }
        }
    const LeafOptics beech = leaf_optics(LeafKind::beech, Season::summer),
                     spruce = leaf_optics(LeafKind::spruce, Season::summer);
    EXPECT_GT(beech.transmittance.g / beech.reflectance.g, 0.7) << "broadleaves let about as much through";
    EXPECT_LT(spruce.transmittance.g / spruce.reflectance.g, 0.5) << "needles don't";
    EXPECT_EQ(leaf_optics(LeafKind::oak, Season::summer).reflectance, glm::vec3(0.070f, 0.118f, 0.034f));
}

TEST(LeafOptics, OfTheTreeAreThoseOfItsSpecies) {
    for (const Species& species : all_species())
        for (const Season season : {Season::spring, Season::summer, Season::autumn, Season::blossom}) {
            GrowthParameters p = species.parameters;
            p.leaves = 300;
            p.season = season;
            const Tree tree = grow(p);
            const PatchScene scene = make_patches(tree);
            const Optics& found = scene.optics[scene.patches[0].optics];
            const bool flowers = season == Season::blossom && species.name == "cherry";
            const LeafOptics asked =
                leaf_optics(p.leaf_color, season == Season::blossom && !flowers ? Season::spring : season);
            for (int c = 0; c < 3; ++c) {
                EXPECT_NEAR(found.reflectance[c], asked.reflectance[c], 0.08 * asked.reflectance[c] + 0.004)
                    << species.name;
                EXPECT_NEAR(found.transmittance[c], asked.transmittance[c], 1e-4) << species.name;
            }
        }
}

TEST(Seasons, WinterIsBareWithTheSameWoodAndConifersStayGreen) {
    for (const Species& species : all_species()) {
        GrowthParameters p = species.parameters;
        p.leaves = 400;
        const Tree summer = grow(p);
        for (const Season season : {Season::spring, Season::autumn, Season::winter, Season::blossom}) {
            p.season = season;
            const Tree other = grow(p);
            EXPECT_EQ(other.parts[0].positions, summer.parts[0].positions) << species.name << ": the same wood";
            EXPECT_EQ(other.parts[0].triangle_patch, summer.parts[0].triangle_patch);
            const bool bare = season == Season::winter && !has_needles(p.leaf_shape);
            EXPECT_EQ(other.leaves.size(), bare ? 0u : 400u) << species.name;
            EXPECT_EQ(other.parts[1].triangles.empty(), bare) << species.name;
        }
        const LeafOptics july = leaf_optics(p.leaf_color, Season::summer),
                         october = leaf_optics(p.leaf_color, Season::autumn);
        if (has_needles(p.leaf_color)) {
            EXPECT_EQ(july.reflectance, october.reflectance) << species.name;
        } else {
            EXPECT_GT(october.reflectance.r, october.reflectance.g) << species.name;
        }
    }
}

} // namespace
} // namespace kokage
