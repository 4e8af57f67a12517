#include "viewer/branching_picture.h"

#include "common/environment/analytic_sky.h"
#include "common/scene/image_file.h"
#include "common/services/random.h"
#include "foliage/light_map_placement.h"
#include "reflection/picture.h"
#include "trees/patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

namespace kokage {
namespace {

struct GenerationColor {
    const char* name;
    glm::vec3 srgb;
};
constexpr std::array kGenerationColors = {
    GenerationColor{"brown", {0.50f, 0.42f, 0.36f}},    GenerationColor{"red", {0.90f, 0.20f, 0.20f}},
    GenerationColor{"orange", {0.98f, 0.60f, 0.10f}},   GenerationColor{"green", {0.35f, 0.75f, 0.20f}},
    GenerationColor{"blue", {0.20f, 0.50f, 0.95f}},     GenerationColor{"violet", {0.70f, 0.35f, 0.95f}},
    GenerationColor{"turquoise", {0.15f, 0.75f, 0.75f}}};

const GenerationColor& generation_color(int order) {
    // The trunk's colour does not come again.
    const int colors = int(kGenerationColors.size());
    return kGenerationColors[std::size_t(order < colors ? std::max(order, 0) : 1 + (order - 1) % (colors - 1))];
}

glm::vec3 linear(const glm::vec3& srgb) {
    return {linear_from_srgb(srgb.r), linear_from_srgb(srgb.g), linear_from_srgb(srgb.b)};
}

/// Strong colours of which neighbours in number differ: hues in steps of the golden angle.
glm::vec3 branch_color(std::int32_t branch) {
    if (branch < 0)
        return glm::vec3(0.6f);
    const float hue = 6 * std::fmod(0.61803399f * float(branch % 100003), 1.f),
                value = 0.65f + 0.35f * float(hash64(std::uint64_t(branch)) >> 40) * 0x1p-24f;
    const glm::vec3 wheel(std::abs(hue - 3) - 1, 2 - std::abs(hue - 2), 2 - std::abs(hue - 4));
    return value * (0.15f + 0.85f * glm::clamp(wheel, 0.f, 1.f));
}

/// Triangles that each have a colour of their own.
class Drawing {
  public:
    PatchScene scene;
    std::vector<glm::vec3> colors; ///< per patch, linear, unshaded

    void add_triangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& color) {
        const auto first = std::uint32_t(scene.positions.size());
        scene.positions.insert(scene.positions.end(), {a, b, c});
        Patch patch;
        patch.first_triangle = std::uint32_t(scene.triangles.size());
        patch.triangle_count = 1;
        patch.kind = PatchKind::bark;
        scene.triangle_patch.push_back(std::uint32_t(scene.patches.size()));
        scene.triangles.push_back({first, first + 1, first + 2});
        scene.patches.push_back(patch);
        colors.push_back(color);
    }

    void add_tube(const glm::vec3& from, const glm::vec3& to, float radius_from, float radius_to,
                  const glm::vec3& color) {
        constexpr int kSides = 8;
        const glm::vec3 way = to - from;
        if (!(glm::length(way) > 0))
            return;
        const glm::vec3 along = glm::normalize(way);
        const glm::vec3 x =
            glm::normalize(glm::cross(along, std::abs(along.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0)));
        const glm::vec3 y = glm::cross(along, x);
        for (int k = 0; k < kSides; ++k) {
            const auto out = [&](int side) {
                const float angle = 2 * kPi * float(side % kSides) / float(kSides);
                return std::cos(angle) * x + std::sin(angle) * y;
            };
            const glm::vec3 a = from + radius_from * out(k), b = from + radius_from * out(k + 1),
                            c = to + radius_to * out(k + 1), d = to + radius_to * out(k);
            add_triangle(a, b, c, color);
            add_triangle(a, c, d, color);
        }
    }

    void add_ball(const glm::vec3& centre, float radius, const glm::vec3& color) {
        constexpr int kRings = 8, kSides = 14;
        const auto at = [&](int ring, int side) {
            const float polar = kPi * float(ring) / float(kRings), turn = 2 * kPi * float(side) / float(kSides);
            return centre + radius * glm::vec3(std::sin(polar) * std::cos(turn), std::cos(polar),
                                               std::sin(polar) * std::sin(turn));
        };
        for (int ring = 0; ring < kRings; ++ring)
            for (int side = 0; side < kSides; ++side) {
                add_triangle(at(ring, side), at(ring, side + 1), at(ring + 1, side + 1), color);
                add_triangle(at(ring, side), at(ring + 1, side + 1), at(ring + 1, side), color);
            }
    }

    void add_circle(const glm::vec3& centre, float radius, const glm::vec3& towards, float thickness,
                    const glm::vec3& color) {
        constexpr int kPieces = 72;
        const glm::vec3 normal = glm::normalize(towards),
                        x = glm::normalize(
                            glm::cross(normal, std::abs(normal.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0))),
                        y = glm::cross(normal, x);
        const auto at = [&](int piece) {
            const float angle = 2 * kPi * float(piece) / float(kPieces);
            return centre + radius * (std::cos(angle) * x + std::sin(angle) * y);
        };
        for (int piece = 0; piece < kPieces; ++piece)
            add_tube(at(piece), at(piece + 1), thickness, thickness, color);
    }
};

/// A picture of patches in their colours, lit a little from above and from the camera so that shapes show; white
/// behind.
Image draw(const PatchScene& scene, const std::vector<glm::vec3>& colors, const Camera& camera, int panel,
           Progress& progress) {
    ShadedScene shaded;
    shaded.patches = &scene;
    const glm::vec3 light = glm::normalize(glm::normalize(camera.position - camera.target) + glm::vec3(0, 0.9f, 0));
    for (std::size_t p = 0; p < scene.patches.size(); ++p) {
        const Patch& patch = scene.patches[p];
        glm::vec3 normal(0.f);
        for (std::uint32_t t = patch.first_triangle; t < patch.first_triangle + patch.triangle_count; ++t) {
            const glm::uvec3& corners = scene.triangles[t];
            const glm::vec3& a = scene.positions[corners.x];
            normal += glm::cross(scene.positions[corners.y] - a, scene.positions[corners.z] - a);
        }
        const float length = glm::length(normal);
        const float facing = length > 0 ? std::abs(glm::dot(normal, light)) / length : 0.5f;
        shaded.radiance_front.push_back((0.3f + 0.7f * facing) * colors[p]);
    }
    shaded.radiance_back = shaded.radiance_front;
    shaded.indirect_front = shaded.indirect_back = shaded.radiance_front;
    PictureOptions options;
    options.width = options.height = panel;
    options.pixel_shadows = false;
    options.gather_rays = 0;
    options.ground = PictureGround::none;
    const RayQueries queries(scene);
    Image picture =
        render_picture(shaded, queries, constant_environment(glm::vec3(1.f)), camera, options, progress).radiance;
    for (float& value : picture.pixels)
        value = srgb_from_linear(std::min(value, 1.f));
    return picture;
}

Image side_by_side(const Image& left, const Image& right) {
    Image both(left.width + right.width, left.height, 3);
    for (int y = 0; y < both.height; ++y)
        for (int x = 0; x < both.width; ++x)
            std::copy_n(x < left.width ? left.at(x, y) : right.at(x - left.width, y), 3, both.at(x, y));
    return both;
}

void add_wood(Drawing& drawing, const Skeleton& skeleton, float thinnest) {
    for (const Branch& branch : skeleton.branches)
        for (std::size_t n = 1; n < branch.nodes.size(); ++n) {
            const Branch::Node &a = branch.nodes[n - 1], &b = branch.nodes[n];
            drawing.add_tube(a.position, b.position, std::max(a.radius_m, thinnest), std::max(b.radius_m, thinnest),
                             linear(generation_color(branch.order).srgb));
        }
}

} // namespace

const char* generation_color_name(int order) {
    return generation_color(order).name;
}

BranchingPicture draw_branching(const Tree& tree, int maps, int panel, Progress& progress) {
    const PatchScene whole = make_patches(tree);
    const Bounds bounds = bounds_of(whole);
    const Camera camera = frame_scene(bounds, 1.f);
    std::vector<glm::vec3> colors;
    for (const Patch& patch : whole.patches)
        colors.push_back(patch.kind == PatchKind::leaf ? branch_color(tree.leaves[patch.leaf].branch)
                                                       : glm::vec3(0.12f));
    const Image left = draw(whole, colors, camera, panel, progress);

    BranchingPicture result;
    const LightMapPlacement placement = place_light_maps(tree, maps);
    result.maps = placement.places.size();
    result.note = placement.note;
    std::set<int> orders;
    for (const Branch& branch : tree.skeleton.branches)
        orders.insert(branch.order);
    result.orders.assign(orders.begin(), orders.end());

    Drawing drawing;
    drawing.scene.optics.resize(1);
    const float size = bounds.diagonal() > 0 ? bounds.diagonal() : 1.f;
    add_wood(drawing, tree.skeleton, 0.0007f * size);
    for (const LightMapPlace& place : placement.places) {
        const glm::vec3 color = linear(generation_color(place.generation).srgb);
        drawing.add_ball(place.position, std::max(0.009f * size, 1.1f * place.clearance_m), color);
        if (place.radius_m > 0)
            drawing.add_circle(place.position, place.radius_m, camera.position - place.position, 0.0012f * size,
                               0.25f * color);
    }
    result.image = side_by_side(left, draw(drawing.scene, drawing.colors, camera, panel, progress));
    return result;
}

} // namespace kokage
