#include "tests/benchmark/crown.h"
#include "common/services/random.h"
#include "tests/benchmark/crown_skeleton.h"
#include "tests/benchmark/rounded.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kokage {

namespace {

constexpr std::uint32_t kLeavesPerTwig = 12;
// The kite, in leaf lengths: base at 0, widest at kWaist, tip at 1.
constexpr double kWaist = 0.42, kHalfWidth = 0.27;
// Of the petiole, in distances between leaves of a twig: about half a leaf's length, as in limes and maples. Without it
// leaves of a twig cut through one another, which no leaf does and which no method with one radiance a leaf side can
// shade well.
constexpr double kPetiole = 2.5;

/// A leaf before its size is known.
struct LeafPlace {
    glm::dvec3 base, along, across; ///< unit vectors in the leaf's plane; normal = across x along
    double relative_length;
    std::int32_t twig;
};

glm::dvec3 random_unit(Random& random) {
    for (;;) {
        const glm::dvec3 v{2 * random.uniform_double() - 1, 2 * random.uniform_double() - 1,
                           2 * random.uniform_double() - 1};
        const double squared = glm::dot(v, v);
        if (squared > 0.01 && squared < 1.0)
            return v / std::sqrt(squared);
    }
}

/// Any unit vector at right angles to a unit vector.
glm::dvec3 perpendicular(const glm::dvec3& v) {
    return glm::normalize(std::abs(v.y) < 0.9 ? glm::cross(v, glm::dvec3(0, 1, 0))
                                              : glm::cross(v, glm::dvec3(1, 0, 0)));
}

/// A point at `distance` before the end of a polyline, and the direction of growth there.
std::pair<glm::dvec3, glm::dvec3> point_before_end(const std::vector<Branch::Node>& nodes, double distance) {
    for (std::size_t n = nodes.size() - 1; n > 0; --n) {
        const glm::dvec3 from(nodes[n - 1].position), to(nodes[n].position);
        const double length = std::sqrt(glm::dot(to - from, to - from));
        if (distance <= length || n == 1) {
            const glm::dvec3 along = (to - from) / std::max(length, 1e-9);
            return {to - std::min(distance, length) * along, along};
        }
        distance -= length;
    }
    return {glm::dvec3(nodes[0].position), glm::dvec3(0, 1, 0)};
}

/// Leaves in a golden spiral along the end of a twig. `spacing` is the distance between successive leaves.
void place_leaves(const Branch& twig, std::int32_t twig_index, std::uint32_t count, double spacing, Random& random,
                  std::vector<LeafPlace>& places) {
    double c = 2 * random.uniform_double() - 1, s = std::sqrt(1 - c * c);
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto [base, growth] = point_before_end(twig.nodes, spacing * i);
        const glm::dvec3 side = perpendicular(growth), other = glm::cross(growth, side);
        const glm::dvec3 out = c * side + s * other;
        const glm::dvec3 towards = glm::normalize(out + 0.5 * growth + 0.6 * random_unit(random));
        // Leaves lie flatter than at random, but far from flat: up weighs as much as chance.
        const glm::dvec3 normal = glm::normalize(glm::dvec3(0, 0.8, 0) + 0.3 * out + random_unit(random));
        glm::dvec3 along = towards - glm::dot(towards, normal) * normal;
        const double length = std::sqrt(glm::dot(along, along));
        along = length > 0.05 ? along / length : perpendicular(normal);
        places.push_back({base + (kPetiole * spacing) * towards, along, glm::cross(along, normal),
                          0.75 + 0.5 * random.uniform_double(), twig_index});
        const double turned = c * kGoldenCos - s * kGoldenSin;
        s = c * kGoldenSin + s * kGoldenCos;
        c = turned;
    }
}

glm::dvec3 leaf_centroid(const LeafPlace& place, double unit_length) {
    // A kite's centroid lies at (waist + 1)/3 of its length: the mean of its two triangles', which share the waist.
    return place.base + (unit_length * place.relative_length * (kWaist + 1.0) / 3.0) * place.along;
}

double hull_area(std::vector<glm::dvec2> points) {
    if (points.size() < 3)
        return 0;
    std::sort(points.begin(), points.end(),
              [](const auto& a, const auto& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
    const auto turn = [](const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
        return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    };
    // Andrew's monotone chain: lower hull, then upper hull.
    std::vector<glm::dvec2> hull;
    for (int pass = 0; pass < 2; ++pass) {
        const std::size_t start = hull.size();
        for (const glm::dvec2& point : points) {
            while (hull.size() >= start + 2 && turn(hull[hull.size() - 2], hull.back(), point) <= 0)
                hull.pop_back();
            hull.push_back(point);
        }
        hull.pop_back();
        std::reverse(points.begin(), points.end());
    }
    double twice_area = 0;
    for (std::size_t i = 0; i < hull.size(); ++i) {
        const glm::dvec2 &a = hull[i], &b = hull[(i + 1) % hull.size()];
        twice_area += a.x * b.y - a.y * b.x;
    }
    return 0.5 * std::abs(twice_area);
}

/// Area of the hull of the leaf centres that the places give with leaves of a size.
double projection_area(const std::vector<LeafPlace>& places, double unit_length) {
    std::vector<glm::dvec2> centres;
    for (const LeafPlace& place : places) {
        const glm::dvec3 centre = leaf_centroid(place, unit_length);
        centres.push_back({centre.x, centre.z});
    }
    return hull_area(std::move(centres));
}

/// The length of a leaf of relative length 1 for which the total area is kBenchLeafAreaIndex x the projection.
double solve_unit_length(const std::vector<LeafPlace>& places) {
    double squares = 0;
    for (const LeafPlace& place : places)
        squares += place.relative_length * place.relative_length;
    const double area_of_unit = kHalfWidth * squares; // a kite of length 1 has area 1 x (2 kHalfWidth) / 2
    double length = 0.1;
    for (int step = 0; step < 20; ++step) // leaf centres move with the size, a little: a fixed point in a few steps
        length = std::sqrt(kBenchLeafAreaIndex * std::max(projection_area(places, length), 1e-2) / area_of_unit);
    return length;
}

TreePart make_foliage(const std::vector<LeafPlace>& places, double unit_length, std::vector<Leaf>& leaves) {
    TreePart part;
    part.kind = TreePartKind::foliage;
    part.material = 0;
    for (const LeafPlace& place : places) {
        const double length = unit_length * place.relative_length;
        const glm::dvec3 waist = place.base + (kWaist * length) * place.along;
        const auto first = std::uint32_t(part.positions.size());
        part.positions.push_back(rounded(place.base));
        part.positions.push_back(rounded(waist + (kHalfWidth * length) * place.across));
        part.positions.push_back(rounded(place.base + length * place.along));
        part.positions.push_back(rounded(waist - (kHalfWidth * length) * place.across));
        part.uvs.insert(part.uvs.end(), {{0.5f, 1.f}, {1.f, float(1 - kWaist)}, {0.5f, 0.f}, {0.f, float(1 - kWaist)}});
        // across x along is the side that was biased upwards: base, +across, tip is counter-clockwise seen from there.
        const glm::vec3 normal(glm::cross(place.across, place.along));
        part.normals.insert(part.normals.end(), 4, normal);
        part.triangles.push_back({first, first + 1, first + 2});
        part.triangles.push_back({first, first + 2, first + 3});
        part.triangle_patch.insert(part.triangle_patch.end(), 2, std::uint32_t(leaves.size()));
        leaves.push_back({rounded(leaf_centroid(place, unit_length)), place.twig});
    }
    return part;
}

/// How a branch is skinned: corners of its rings, and how many corners share a patch.
struct BarkStyle {
    int sides, sides_per_patch;
    bool patch_per_segment;
};
BarkStyle bark_style(int order, bool is_twig) {
    if (is_twig)
        return {3, 3, false}; // thinner than a leaf's midrib is long: one radiance is enough
    constexpr std::array<BarkStyle, 4> styles{{{10, 2, true}, {6, 2, true}, {5, 5, true}, {4, 4, true}}};
    return styles[std::size_t(std::min(order, 3))];
}

/// Tapered prisms, closed by a point at the tip. Base rings stand inside the parent.
void add_bark(const Branch& branch, BarkStyle style, TreePart& part, std::uint32_t& patches) {
    const auto& nodes = branch.nodes;
    const auto first = std::uint32_t(part.positions.size());
    const auto sides = std::uint32_t(style.sides);
    // Corners of a regular polygon without cos and sin of the library: products of one rotation, whose values are
    // below.
    constexpr std::array<glm::dvec2, 11> rotation{{{},
                                                   {},
                                                   {},
                                                   {-0.5, 0.86602540378443865},
                                                   {0, 1},
                                                   {0.30901699437494742, 0.95105651629515357},
                                                   {0.5, 0.86602540378443865},
                                                   {},
                                                   {},
                                                   {},
                                                   {0.80901699437494742, 0.58778525229247313}}};
    const glm::dvec2 turn = rotation[sides];
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const glm::dvec3 before(nodes[n > 0 ? n - 1 : 0].position),
            after(nodes[std::min(n + 1, nodes.size() - 1)].position);
        const glm::dvec3 along = glm::normalize(after - before);
        // Rings of a branch share one reference direction, so that prisms are not twisted.
        const glm::dvec3 reference = std::abs(along.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
        const glm::dvec3 u = glm::normalize(glm::cross(along, reference)), v = glm::cross(along, u);
        glm::dvec2 corner(1, 0);
        const double radius = n + 1 < nodes.size() ? nodes[n].radius_m : 0.25 * nodes[n].radius_m;
        for (std::uint32_t i = 0; i < sides; ++i) {
            const glm::dvec3 out = corner.x * u + corner.y * v;
            part.positions.push_back(rounded(glm::dvec3(nodes[n].position) + radius * out));
            part.normals.push_back(glm::vec3(out));
            part.uvs.push_back({float(i) / float(sides), float(n)});
            corner = {corner.x * turn.x - corner.y * turn.y, corner.x * turn.y + corner.y * turn.x};
        }
    }
    const auto groups = sides / std::uint32_t(style.sides_per_patch);
    const auto last = std::uint32_t(nodes.size() - 1);
    // Patches are consecutive: all triangles of one (segment, group) before the next; a twig's whole length is one.
    for (std::uint32_t n = 0; n < last; ++n)
        for (std::uint32_t i = 0; i < sides; ++i) {
            const std::uint32_t next = (i + 1) % sides, ring = first + n * sides;
            const std::uint32_t patch =
                patches + (style.patch_per_segment ? n * groups : 0) + i / std::uint32_t(style.sides_per_patch);
            part.triangles.push_back({ring + i, ring + next, ring + sides + next});
            part.triangles.push_back({ring + i, ring + sides + next, ring + sides + i});
            part.triangle_patch.insert(part.triangle_patch.end(), 2, patch);
        }
    patches += style.patch_per_segment ? last * groups : groups;
}

TreePart make_bark(const Skeleton& skeleton, std::size_t first_twig, std::uint32_t& patches) {
    TreePart part;
    part.kind = TreePartKind::bark;
    part.material = 1;
    for (std::size_t b = 0; b < skeleton.branches.size(); ++b)
        add_bark(skeleton.branches[b], bark_style(skeleton.branches[b].order, b >= first_twig), part, patches);
    return part;
}

TreeMaterial make_material(const char* name, const glm::vec3& color, float transmission) {
    TreeMaterial material;
    material.name = name;
    material.base_color = color;
    material.diffuse_transmission = transmission;
    return material;
}

} // namespace

double ground_projection_area(const std::vector<Leaf>& leaves) {
    std::vector<glm::dvec2> centres;
    for (const Leaf& leaf : leaves)
        centres.push_back({leaf.centre.x, leaf.centre.z});
    return hull_area(std::move(centres));
}

double foliage_area(const Tree& tree) {
    double area = 0;
    for (const TreePart& part : tree.parts) {
        if (part.kind != TreePartKind::foliage)
            continue;
        for (const glm::uvec3& t : part.triangles) {
            const glm::dvec3 a(part.positions[t.x]), b(part.positions[t.y]), c(part.positions[t.z]);
            area += 0.5 * glm::length(glm::cross(b - a, c - a));
        }
    }
    return area;
}

Tree make_bench_crown(std::uint32_t leaves, std::uint64_t seed) {
    const std::uint32_t twigs = (leaves + kLeavesPerTwig - 1) / kLeavesPerTwig;
    Tree tree;
    tree.name = "bench-crown-" + std::to_string(leaves);
    tree.source = "benchmark crown: " + std::to_string(leaves) + " leaves, seed " + std::to_string(seed);
    tree.skeleton = make_bench_skeleton(twigs, seed);
    const std::size_t first_twig = tree.skeleton.branches.size() - twigs;

    // Successive leaves stand a fifth of a leaf apart; 0.16 m is a leaf's length at 30,000 leaves.
    const double spacing = 0.2 * 0.16 * std::sqrt(30000.0 / leaves);
    std::vector<LeafPlace> places;
    for (std::uint32_t twig = 0; twig < twigs; ++twig) {
        Random random(seed, 1'000'000 + std::uint64_t(twig));
        const auto index = std::int32_t(first_twig + twig);
        const auto count =
            std::uint32_t(std::uint64_t(leaves) * (twig + 1) / twigs - std::uint64_t(leaves) * twig / twigs);
        place_leaves(tree.skeleton.branches[std::size_t(index)], index, count, spacing, random, places);
    }
    tree.parts.push_back(make_foliage(places, solve_unit_length(places), tree.leaves));
    tree.parts.push_back(make_bark(tree.skeleton, first_twig, tree.bark_patch_count));
    tree.materials.push_back(make_material("leaf", {0.18f, 0.5f, 0.1f}, 0.45f));
    tree.materials.push_back(make_material("bark", {0.15f, 0.1f, 0.07f}, -1.f));
    return tree;
}

} // namespace kokage
