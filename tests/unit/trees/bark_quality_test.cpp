// Bark of all species and several seeds, measured tube by tube: no cracks, no triangle turned inside out (that is what
// self-crossings of a tube look like), no spikes, no stretched texture.
#include "tests/unit/trees/growth_shape.h"
#include "trees/growth.h"
#include "trees/growth/bark.h"
#include "trees/growth/tube.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <gtest/gtest.h>
#include <map>

namespace kokage {
namespace {

using Mesh = OpenMesh::TriMesh_ArrayKernelT<>;

/// A tube welded where its places are the same (the texture's seam cuts it open): is it closed, and does OpenMesh take
/// every face?
bool is_closed_manifold(const TreePart& bark, std::size_t first, std::size_t last) {
    Mesh mesh;
    std::map<std::array<float, 3>, Mesh::VertexHandle> places;
    const auto vertex = [&](std::uint32_t v) {
        const glm::vec3& p = bark.positions[v];
        const auto [entry, is_new] = places.try_emplace({p.x, p.y, p.z});
        if (is_new)
            entry->second = mesh.add_vertex({p.x, p.y, p.z});
        return entry->second;
    };
    for (std::size_t t = first; t < last; ++t) {
        const glm::uvec3 v = bark.triangles[t];
        if (!mesh.add_face(vertex(v.x), vertex(v.y), vertex(v.z)).is_valid())
            return false;
    }
    return std::none_of(mesh.edges_begin(), mesh.edges_end(), [&](auto edge) { return mesh.is_boundary(edge); });
}

/// The place on a tube's centre line nearest to a point: direction out from the line, and the radius there.
struct OnLine {
    glm::vec3 out;
    float radius_m, spacing_m;
};
OnLine nearest_on(const Tube& tube, const glm::vec3& point) {
    OnLine best{{0, 0, 0}, 0, 0};
    float nearest = 1e30f;
    for (std::size_t i = 0; i + 1 < tube.rings.size(); ++i) {
        const Ring &a = tube.rings[i], &b = tube.rings[i + 1];
        const glm::vec3 way = b.centre - a.centre;
        const float t = std::clamp(glm::dot(point - a.centre, way) / std::max(glm::dot(way, way), 1e-20f), 0.f, 1.f);
        const glm::vec3 here = a.centre + t * way;
        if (const float d = glm::distance(here, point); d < nearest) {
            nearest = d;
            best = {point - here, std::max(a.radius_m, b.radius_m), glm::length(way)};
        }
    }
    return best;
}

struct BarkQuality {
    bool is_manifold = true;
    std::size_t inside_out = 0, sides = 0;
    double area = 0, area_above_2_5 = 0, area_above_6 = 0; ///< of the texture's stretch
    double longest_edge = 0;                               ///< over local radius + distance of the rings
};

BarkQuality measure(const GrowthParameters& p) {
    const Tree tree = grow(p);
    TreePart bark;
    std::vector<BarkPlace> patches;
    const std::vector<Tube> tubes = make_tubes(tree.skeleton, p);
    make_bark(tubes, p, bark, &patches);
    const auto branch = [&](std::size_t triangle) { return patches[bark.triangle_patch[triangle]].branch; };
    BarkQuality quality;
    for (std::size_t first = 0, last = 0; first < bark.triangles.size(); first = last) {
        while (last < bark.triangles.size() && branch(last) == branch(first))
            ++last;
        quality.is_manifold &= is_closed_manifold(bark, first, last);
        for (std::size_t t = first; t < last; ++t) {
            const glm::uvec3 v = bark.triangles[t];
            const glm::vec3 a = bark.positions[v.x], b = bark.positions[v.y], c = bark.positions[v.z];
            const OnLine line = nearest_on(tubes[branch(t)], (a + b + c) / 3.f);
            const float edge = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
            quality.longest_edge = std::max(quality.longest_edge, double(edge / (line.radius_m + line.spacing_m)));
            const bool is_foot = bark.uvs[v.x].y == bark.uvs[v.y].y && bark.uvs[v.x].y == bark.uvs[v.z].y;
            if (is_foot) // the lid that closes the lower end, in the parent or on the ground
                continue;
            ++quality.sides;
            quality.inside_out += glm::dot(glm::cross(b - a, c - a), line.out) < 0;
            const double here = triangle_area(bark, v), s = texture_stretch(bark, v);
            quality.area += here;
            quality.area_above_2_5 += s > 2.5 ? here : 0;
            quality.area_above_6 += s > 6 ? here : 0;
        }
    }
    return quality;
}

TEST(BarkQuality, TenSpeciesHaveNoCracksNoCrossingsNoSpikesNoStretchedTexture) {
    for (const Species& species : all_species())
        for (const std::uint64_t seed : {1, 2, 3}) {
            GrowthParameters p = species.parameters;
            p.leaves = 8000;
            p.seed = seed;
            const BarkQuality quality = measure(p);
            const std::string what = species.name + ", seed " + std::to_string(seed);
            EXPECT_TRUE(quality.is_manifold) << what;
            EXPECT_GT(quality.sides, 4000u) << what;
            EXPECT_EQ(quality.inside_out, 0u) << what;
            EXPECT_LT(quality.longest_edge, 3.0) << what;
            EXPECT_LT(quality.area_above_2_5, 0.08 * quality.area) << what;
            EXPECT_LT(quality.area_above_6, 0.02 * quality.area) << what;
        }
}

// The measure itself sees what it is to find: a tube that is bent so sharply that its rings cross.
TEST(BarkQuality, TheMeasureSeesATubeThatIsTurnedInsideOut) {
    TreePart bark;
    bark.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    bark.uvs = {{0, 0}, {1, 0}, {0, 4}};
    bark.triangles = {{0, 1, 2}};
    EXPECT_FALSE(is_closed_manifold(bark, 0, 1)) << "one triangle is open";
    EXPECT_NEAR(texture_stretch(bark, {0, 1, 2}), 4, 1e-6);
}

} // namespace
} // namespace kokage
