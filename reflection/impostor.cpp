#include "reflection/impostor.h"

#include "common/services/error.h"
#include "common/services/parallel.h"
#include "common/services/random.h"
#include "reflection/sampling.h"
#include "reflection/surface_shading.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kokage {
namespace {

/// Gives texels that nothing was seen in the mean of their neighbours, ring by ring, so that filtering brings no black
/// in; at last, where a view is empty, nothing.
void fill_empty(Image& image, std::vector<std::uint8_t> known) {
    const int width = image.width, height = image.height;
    for (int round = 0; round < std::max(width, height); ++round) {
        std::vector<std::uint8_t> next = known;
        bool changed = false;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                if (known[std::size_t(y) * std::size_t(width) + std::size_t(x)])
                    continue;
                glm::vec3 sum(0.f);
                int count = 0;
                for (int j = std::max(0, y - 1); j <= std::min(height - 1, y + 1); ++j)
                    for (int i = std::max(0, x - 1); i <= std::min(width - 1, x + 1); ++i)
                        if (known[std::size_t(j) * std::size_t(width) + std::size_t(i)]) {
                            const float* texel = image.at(i, j);
                            sum += glm::vec3(texel[0], texel[1], texel[2]);
                            ++count;
                        }
                if (count == 0)
                    continue;
                for (std::size_t c = 0; c < 3; ++c)
                    image.at(x, y)[c] = sum[c] / float(count);
                next[std::size_t(y) * std::size_t(width) + std::size_t(x)] = 1;
                changed = true;
            }
        if (!changed)
            return;
        known = std::move(next);
    }
}

/// The normal of the seen side: interpolated where the scene has normals.
glm::vec3 seen_normal(const ShadedScene& scene, const RayHit& hit, const glm::vec3& direction) {
    glm::vec3 normal = hit.geometric_normal;
    if (!scene.normals.empty()) {
        const glm::uvec3 corners = scene.patches->triangles[hit.triangle];
        const glm::vec3 smooth = (1 - hit.barycentric.x - hit.barycentric.y) * scene.normals[corners.x] +
                                 hit.barycentric.x * scene.normals[corners.y] +
                                 hit.barycentric.y * scene.normals[corners.z];
        if (const float length = glm::length(smooth); length > 1e-6f)
            normal = smooth / length;
    }
    return glm::dot(normal, direction) > 0 ? -normal : normal;
}

void paste(const Image& from, int x0, int y0, Image& into) {
    for (int y = 0; y < from.height; ++y)
        std::copy_n(from.at(0, y), std::size_t(from.width) * std::size_t(from.channels), into.at(x0, y0 + y));
}

/// The cutoff that leaves as many solid texels as the alphas add up to, times `share`.
float covering_cutoff(const Image& alpha, double share) {
    double sum = 0;
    for (const float a : alpha.pixels)
        sum += double(a);
    std::vector<float> sorted = alpha.pixels;
    const std::size_t solid = std::clamp<std::size_t>(std::size_t(std::lround(share * sum)), 1, sorted.size());
    std::nth_element(sorted.begin(), sorted.begin() + std::ptrdiff_t(solid - 1), sorted.end(), std::greater<>());
    return std::clamp(sorted[solid - 1], 1.f / 255, 1.f);
}

/// Colours as the solid texels have to show them: each the mean of its neighbourhood by alpha, so that sparse needles
/// count beside dense wood, which the cutoff favours; then scaled so that solid texels have the views' mean colour.
Image color_of_solid(const Image& color, const Image& alpha, float cutoff) {
    Image result = color;
    glm::dvec3 sent(0.0), shown(0.0);
    double covered = 0, solid = 0;
    for (int y = 0; y < color.height; ++y)
        for (int x = 0; x < color.width; ++x) {
            glm::dvec3 sum(0.0);
            double weight = 0;
            for (int j = std::max(0, y - 1); j <= std::min(color.height - 1, y + 1); ++j)
                for (int i = std::max(0, x - 1); i <= std::min(color.width - 1, x + 1); ++i) {
                    const double w = double(alpha.at(i, j)[0]) * (i == x && j == y ? 2 : 1);
                    sum += w * glm::dvec3(color.at(i, j)[0], color.at(i, j)[1], color.at(i, j)[2]);
                    weight += w;
                }
            const float own = alpha.at(x, y)[0];
            covered += double(own);
            solid += own >= cutoff ? 1 : 0;
            for (std::size_t c = 0; c < 3; ++c) {
                if (weight > 0)
                    result.at(x, y)[c] = float(sum[c] / weight);
                sent[c] += double(own * color.at(x, y)[c]);
                shown[c] += own >= cutoff ? double(result.at(x, y)[c]) : 0;
            }
        }
    for (std::size_t i = 0; i < result.pixels.size(); ++i)
        if (shown[i % 3] > 0 && covered > 0)
            result.pixels[i] *= float(sent[i % 3] / covered * solid / shown[i % 3]);
    return result;
}

/// Alphas are multiples of 1/16: a little noise tells texels of the same alpha apart, so that any number of them can be
/// solid; no texel becomes or ceases to be empty.
void spread_alphas(Image& alpha) {
    for (std::size_t i = 0; i < alpha.pixels.size(); ++i)
        if (alpha.pixels[i] > 0 && alpha.pixels[i] < 1)
            alpha.pixels[i] -= float(hash64(i) >> 40) * 0x1p-24f / 17;
}

/// How much of each coarse pixel a scene covers, from some sides between the first two cards.
std::vector<float> coarse_coverage(const ShadedScene& scene, const RayQueries& queries, const Environment& environment,
                                   const ViewFrame& first, float azimuth, int cards, Progress& progress) {
    constexpr int sides = 6, height = 24, samples = 16;
    const int width = std::clamp(int(std::lround(height * first.half_width / first.half_height)), 2, 4 * height);
    std::vector<float> coverage;
    for (int side = 0; side < sides; ++side) {
        ViewFrame frame = first;
        const float angle = azimuth + kPi / float(cards) * (float(side) + 0.5f) / sides;
        frame.towards_viewer = {std::sin(angle), 0, std::cos(angle)};
        const CapturedView view = capture_view(scene, queries, environment, frame, width, height, samples, progress);
        coverage.insert(coverage.end(), view.alpha.pixels.begin(), view.alpha.pixels.end());
    }
    return coverage;
}

float solid_percentile_99(const Image& color, const Image& alpha, float cutoff) {
    std::vector<float> values;
    for (std::size_t i = 0; i < alpha.pixels.size(); ++i)
        if (alpha.pixels[i] >= cutoff)
            values.insert(values.end(), {color.pixels[3 * i], color.pixels[3 * i + 1], color.pixels[3 * i + 2]});
    if (values.empty())
        return 1;
    const std::size_t at = values.size() * 99 / 100;
    std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(at), values.end());
    return values[at] > 0 && std::isfinite(values[at]) ? values[at] : 1.f;
}

/// Cards stand one behind the other and together cover more than each. Fewer texels are then made solid, down to a
/// quarter, if that brings what is covered, seen from afar, nearer to the scene's: it does for bare trees, while dense
/// crowns would only lose their outline.
void choose_cutoff(Impostor& impostor, const std::vector<float>& wanted, const Environment& environment, float azimuth,
                   int cards, Progress& progress) {
    double least = std::numeric_limits<double>::infinity();
    float best = 0.5f;
    for (const double share : {1.0, 0.85, 0.7, 0.55, 0.4, 0.25}) {
        impostor.alpha_cutoff = covering_cutoff(impostor.alpha, share);
        ImpostorScene scene;
        make_impostor_scene(impostor, scene);
        const RayQueries queries(scene.patches);
        const std::vector<float> covered =
            coarse_coverage(scene.shaded, queries, environment, impostor.faces[0], azimuth, cards, progress);
        double error = 0;
        for (std::size_t i = 0; i < wanted.size(); ++i)
            error += std::abs(double(covered[i] - wanted[i]));
        if (error < least) {
            least = error;
            best = impostor.alpha_cutoff;
        }
    }
    impostor.alpha_cutoff = best;
}

} // namespace

ViewFrame frame_of(const PatchScene& scene, float azimuth) {
    const Bounds bounds = bounds_of(scene);
    ViewFrame frame;
    frame.centre = bounds.centre();
    frame.towards_viewer = {std::sin(azimuth), 0, std::cos(azimuth)};
    float reach = 0;
    for (const glm::uvec3& t : scene.triangles)
        for (std::size_t c = 0; c < 3; ++c) {
            const glm::vec3 d = scene.positions[t[c]] - frame.centre;
            reach = std::max(reach, std::hypot(d.x, d.z));
        }
    frame.half_width = std::max(reach, 1e-6f) * 1.01f;
    frame.half_height = std::max(0.5f * (bounds.high.y - bounds.low.y), 1e-6f) * 1.01f;
    return frame;
}

double coverage(const Image& alpha) {
    double sum = 0;
    for (const float share : alpha.pixels)
        sum += double(share);
    return sum / double(alpha.pixels.size());
}

CapturedView capture_view(const ShadedScene& scene, const RayQueries& queries, const Environment& environment,
                          const ViewFrame& frame, int width, int height, int samples, Progress& progress) {
    if (width < 1 || height < 1 || samples < 1)
        throw InputError("view: " + std::to_string(width) + " x " + std::to_string(height) + " pixels of " +
                         std::to_string(samples) + " samples; give at least 1 of each");
    const LightChoice lights(environment, 1);
    const SurfaceShading surfaces(scene, queries, lights, false);
    const glm::vec3 right = frame.right(), up(0, 1, 0);
    // Rays start outside of everything.
    const float far = 2 * (frame.half_width + frame.half_height);
    CapturedView view{Image(width, height, 3), Image(width, height, 1), Image(width, height, 3)};
    std::vector<std::uint8_t> known(std::size_t(width) * std::size_t(height), 0);
    parallel_blocks(std::size_t(height), 4, [&](std::size_t begin, std::size_t end) {
        progress.throw_if_stopped();
        ShadingScratch scratch;
        for (int y = int(begin); y < int(end); ++y)
            for (int x = 0; x < width; ++x) {
                const std::size_t pixel = std::size_t(y) * std::size_t(width) + std::size_t(x);
                glm::dvec3 color(0.0), normal(0.0);
                int hits = 0;
                for (int s = 0; s < samples; ++s) {
                    const glm::vec2 u =
                        multi_jittered(std::uint32_t(s), std::uint32_t(samples), std::uint32_t(hash64(pixel) >> 32));
                    const float a = 2 * (float(x) + u.x) / float(width) - 1,
                                b = 1 - 2 * (float(y) + u.y) / float(height);
                    const glm::vec3 origin = frame.centre + a * frame.half_width * right + b * frame.half_height * up +
                                             far * frame.towards_viewer;
                    RayHit hit;
                    if (!queries.first_hit(origin, -frame.towards_viewer, 0, std::numeric_limits<float>::infinity(),
                                           hit) ||
                        hit.ground)
                        continue;
                    const SurfacePoint at = surfaces.point(origin, -frame.towards_viewer, hit);
                    color += glm::dvec3(surfaces.radiance(at, -frame.towards_viewer, {}, scratch).total());
                    normal += glm::dvec3(seen_normal(scene, hit, -frame.towards_viewer));
                    ++hits;
                }
                view.alpha.at(x, y)[0] = float(hits) / float(samples);
                if (hits == 0)
                    continue;
                known[pixel] = 1;
                const double length = glm::length(normal);
                for (std::size_t c = 0; c < 3; ++c) {
                    view.color.at(x, y)[c] = float(color[c] / hits);
                    view.normal.at(x, y)[c] =
                        float(length > 1e-9 ? normal[c] / length : double(frame.towards_viewer[c]));
                }
            }
    });
    fill_empty(view.color, known);
    fill_empty(view.normal, known);
    return view;
}

Impostor make_impostor(const ShadedScene& scene, const RayQueries& queries, const Environment& environment, int cards,
                       int size, float azimuth, Progress& progress) {
    if (cards < 1 || cards > 16 || size < 8 || size > 4096)
        throw InputError("impostor: " + std::to_string(cards) + " cards of " + std::to_string(size) +
                         " texels; 1 to 16 of 8 to 4096 are possible");
    const ViewFrame first = frame_of(*scene.patches, azimuth);
    const int width = std::clamp(int(std::lround(float(size) * first.half_width / first.half_height)), 8, 4096);
    Impostor impostor;
    impostor.color = Image(2 * width, cards * size, 3);
    impostor.alpha = Image(2 * width, cards * size, 1);
    impostor.normal = Image(2 * width, cards * size, 3);
    for (int face = 0; face < 2 * cards; ++face) {
        const float angle = azimuth + kPi * float(face / 2) / float(cards) + kPi * float(face % 2);
        const ViewFrame frame = frame_of(*scene.patches, angle);
        CapturedView view = capture_view(scene, queries, environment, frame, width, size, 16, progress);
        for (std::size_t i = 0; i < view.normal.pixels.size(); i += 3) { // into the card's own frame
            const glm::vec3 n(view.normal.pixels[i], view.normal.pixels[i + 1], view.normal.pixels[i + 2]);
            view.normal.pixels[i] = glm::dot(n, frame.right());
            view.normal.pixels[i + 1] = n.y;
            view.normal.pixels[i + 2] = glm::dot(n, frame.towards_viewer);
        }
        paste(view.color, face % 2 * width, face / 2 * size, impostor.color);
        paste(view.alpha, face % 2 * width, face / 2 * size, impostor.alpha);
        paste(view.normal, face % 2 * width, face / 2 * size, impostor.normal);
        impostor.faces.push_back(frame);
    }
    spread_alphas(impostor.alpha);
    choose_cutoff(impostor, coarse_coverage(scene, queries, environment, first, azimuth, cards, progress), environment,
                  azimuth, cards, progress);
    impostor.color = color_of_solid(impostor.color, impostor.alpha, impostor.alpha_cutoff);
    impostor.scale = solid_percentile_99(impostor.color, impostor.alpha, impostor.alpha_cutoff);
    return impostor;
}

void make_impostor_scene(const Impostor& impostor, ImpostorScene& scene) {
    scene = {};
    PatchScene& patches = scene.patches;
    const std::size_t count = impostor.faces.size(), rows = count / 2;
    for (std::size_t f = 0; f < count; ++f) {
        const ViewFrame& face = impostor.faces[f];
        const std::uint32_t first = std::uint32_t(patches.positions.size());
        const glm::vec3 right = face.half_width * face.right(), up(0, face.half_height, 0);
        // Front and back lie a hair apart, so that a ray meets the one that looks at it.
        const glm::vec3 centre = face.centre + 1e-4f * face.half_width * face.towards_viewer;
        const float u = 0.5f * float(f % 2), v = float(f / 2) / float(rows), height = 1 / float(rows);
        patches.positions.insert(patches.positions.end(),
                                 {centre - right - up, centre + right - up, centre + right + up, centre - right + up});
        patches.uvs.insert(patches.uvs.end(), {{u, v + height}, {u + 0.5f, v + height}, {u + 0.5f, v}, {u, v}});
        patches.patches.push_back({.first_triangle = std::uint32_t(patches.triangles.size()),
                                   .triangle_count = 2,
                                   .optics = 0,
                                   .kind = PatchKind::leaf,
                                   .leaf = std::uint32_t(f)});
        patches.triangles.push_back({first, first + 1, first + 2});
        patches.triangles.push_back({first, first + 2, first + 3});
        for (int k = 0; k < 2; ++k) {
            patches.triangle_patch.push_back(std::uint32_t(f));
            patches.triangle_mask.push_back(0);
            scene.shaded.triangle_look.push_back(0);
        }
    }
    patches.leaf_count = std::uint32_t(count);
    patches.optics.push_back({});
    patches.masks.push_back(
        {std::make_shared<Image>(impostor.alpha), impostor.alpha_cutoff, TextureWrap::clamp, TextureWrap::clamp});
    SurfaceLook look;
    look.base_color_texture = std::make_shared<Image>(impostor.color);
    look.wrap_u = look.wrap_v = TextureWrap::clamp;
    scene.shaded.looks = {look};
    scene.shaded.radiance_front.assign(count, glm::vec3(1.f));
    scene.shaded.radiance_back = scene.shaded.radiance_front;
    scene.shaded.indirect_front = scene.shaded.indirect_back = scene.shaded.radiance_front;
    scene.shaded.patches = &scene.patches;
}

} // namespace kokage
