#include "reflection/relief_surfaces.h"
#include "reflection/relief/surface_entries.h"
#include "reflection/scene_relief.h"
#include "reflection/view_frustum.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace kokage {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kRaysAhead = 512;

/// `direction` turned as `from` is turned to become `to` (unit, less than a right angle apart) the shortest way.
glm::vec3 turned(const glm::vec3& direction, const glm::vec3& from, const glm::vec3& to) {
    const float cosine = glm::dot(from, to);
    if (!(cosine > 0) || cosine > 1 - 1e-7f)
        return direction;
    const glm::vec3 axis = glm::cross(from, to), once = glm::cross(axis, direction);
    return glm::normalize(direction + once + glm::cross(axis, once) / (1 + cosine));
}

glm::vec3 within(const ReliefPoint& from, const glm::vec3& direction) {
    return turned(direction, from.mesh_normal, from.facet_normal);
}

} // namespace

/// Where a camera ray reaches the outside of a mesh with relief.
struct ReliefSurfaces::Entry {
    RayHit hit;
    std::uint32_t prism = SceneRelief::kNone;
    bool outside = false; ///< of a mesh with relief, where the ray goes in
    bool enters = false;  ///< relief that is seen from here
};

ReliefSurfaces::ReliefSurfaces(const ShadedScene& scene, const RayQueries& queries, const Environment& environment,
                               const CameraFrame& frame, bool skip_thin, Progress& progress, WorkReport& report)
    : scene_(scene), queries_(queries), eye_(frame.position), pixel_(pixel_size(frame)), skip_thin_(skip_thin),
      relief_(make_scene_relief(scene, frame, skip_thin, progress, report)) {
    if (relief_)
        open_.emplace(environment, scene.patches->ground);
}

ReliefSurfaces::~ReliefSurfaces() = default;

float ReliefSurfaces::strength_at(const Entry& entry) const {
    const ReliefShell::Prism& prism = relief_->shell.prisms[entry.prism];
    if (prism.is_solid)
        return 0;
    if (!skip_thin_)
        return 1;
    const glm::vec3 of_triangle{1 - entry.hit.barycentric.x - entry.hit.barycentric.y, entry.hit.barycentric};
    const glm::vec3 weights(of_triangle[prism.corners[0]], of_triangle[prism.corners[1]],
                            of_triangle[prism.corners[2]]);
    return relief_strength(relief_->shell.thickness_m(prism, weights) / std::max(entry.hit.distance * pixel_, 1e-30f));
}

ReliefSurfaces::Entry ReliefSurfaces::entry_at(const RayHit& hit, const glm::vec3& direction) const {
    Entry entry{hit, hit.ground ? SceneRelief::kNone : relief_->prism[hit.triangle]};
    entry.outside = entry.prism != SceneRelief::kNone && glm::dot(hit.geometric_normal, direction) < 0;
    entry.enters = entry.outside && strength_at(entry) > 0;
    return entry;
}

/// The next outside with relief; false where the ray ends: at nothing, or at what has no relief, which `hit` then has.
bool ReliefSurfaces::next_entry(CameraHit& hit, Entry& last, float after, float before) const {
    const auto beyond = [&](float distance) { return distance * (1 + 1e-6f) + 1e-3f * queries_.ray_offset(); };
    float near = beyond(after);
    for (RayHit next; queries_.first_hit(eye_, hit.direction, near, before, next); near = beyond(next.distance)) {
        const Entry entry = entry_at(next, hit.direction);
        if (entry.prism != SceneRelief::kNone && !entry.outside)
            continue; // where the ray comes out of the mesh again
        if (entry.enters) {
            last = entry;
            return true;
        }
        hit.found = true;
        hit.hit = next;
        return false;
    }
    return false;
}

/// As a hit of the scene: relief, or the mesh where it has no room for any.
CameraHit ReliefSurfaces::met(const SurfaceHit& hit, const glm::vec3& direction) const {
    CameraHit result;
    result.direction = direction;
    result.found = true;
    result.hit.distance = hit.distance;
    result.hit.triangle = relief_->scene_triangle[hit.triangle];
    result.hit.barycentric = {hit.weights.y, hit.weights.z};
    const PatchScene& patches = *scene_.patches;
    const glm::uvec3 corners = patches.triangles[result.hit.triangle];
    const glm::vec3 o = patches.positions[corners.x];
    const glm::vec3 across = glm::cross(patches.positions[corners.y] - o, patches.positions[corners.z] - o);
    const float area = glm::length(across);
    const glm::vec3 facet = area > 0 ? across / area : hit.geometric_normal;
    result.hit.geometric_normal = facet;
    result.is_relief = hit.thickness_m > 0;
    if (!result.is_relief) {
        if (glm::dot(facet, direction) > 0) // met from the side of the relief before it
            result.hit.geometric_normal = -facet;
        return result;
    }
    result.relief.surfaces = this;
    result.relief.hit = hit;
    result.relief.facet_normal = facet;
    const glm::vec3 smooth = hit.weights.x * scene_.normals[corners.x] + hit.weights.y * scene_.normals[corners.y] +
                             hit.weights.z * scene_.normals[corners.z];
    const float length = glm::length(smooth);
    result.relief.mesh_normal = length > 1e-6f ? smooth / length : facet;
    const ReliefMap& map = relief_->maps[std::size_t(relief_->shell.prisms[hit.triangle].layer) - 1];
    result.relief.openness = 1 - hit.strength * (1 - map.openness.lookup(hit.uv));
    return result;
}

void ReliefSurfaces::first_hits_of_meshes(std::span<CameraHit> hits) const {
    constexpr std::size_t kAtOnce = 64;
    std::array<Ray, kAtOnce> rays;
    std::array<RayHit, kAtOnce> met;
    std::array<std::uint8_t, kAtOnce> found;
    for (std::size_t first = 0; first < hits.size(); first += kAtOnce) {
        const std::size_t count = std::min(kAtOnce, hits.size() - first);
        for (std::size_t k = 0; k < count; ++k)
            rays[k] = {eye_, hits[first + k].direction, 0.f, kInfinity};
        queries_.first_hits(std::span(rays).first(count), std::span(met).first(count), std::span(found).first(count));
        for (std::size_t k = 0; k < count; ++k) {
            hits[first + k].is_relief = false;
            hits[first + k].found = found[k] != 0;
            hits[first + k].hit = met[k];
        }
    }
}

void ReliefSurfaces::first_hits(std::span<CameraHit> hits) const {
    if (!relief_)
        return first_hits_of_meshes(hits);
    std::vector<std::size_t> entering;
    std::vector<SurfaceRay> rays;
    std::vector<Entry> entries;
    first_hits_of_meshes(hits);
    for (std::size_t i = 0; i < hits.size(); ++i) {
        CameraHit& hit = hits[i];
        if (!hit.found)
            continue;
        const Entry entry = entry_at(hit.hit, hit.direction);
        if (!entry.enters)
            continue;
        hit.found = false;
        entering.push_back(i);
        entries.push_back(entry);
        rays.push_back({eye_, hit.direction, 0, 0, 1});
    }
    if (entering.empty())
        return;
    std::vector<SurfaceHit> found(entering.size());
    std::vector<bool> begun(entering.size());
    const auto next = [&](std::size_t k, float after, float before, SurfaceEntry& entry) {
        if (begun[k] && !next_entry(hits[entering[k]], entries[k], after, before))
            return false;
        begun[k] = true;
        entry = {entries[k].prism, entries[k].hit.distance};
        return true;
    };
    const auto strength = [&](std::size_t k, float) { return strength_at(entries[k]); };
    trace_from_outside(*relief_->surface, rays, next, strength, found);
    for (std::size_t k = 0; k < entering.size(); ++k) {
        CameraHit& hit = hits[entering[k]];
        if (found[k].found() && !(hit.found && hit.hit.distance < found[k].distance))
            hit = met(found[k], hit.direction);
    }
}

void ReliefSurfaces::hides(const ReliefPoint& from, std::span<const glm::vec3> directions,
                           std::span<std::uint8_t> hidden) const {
    constexpr std::size_t kAtOnce = 16;
    std::array<SurfaceHit, kAtOnce> starts;
    std::array<glm::vec3, kAtOnce> turned_directions;
    std::array<float, kAtOnce> ways_out;
    for (std::size_t first = 0; first < directions.size(); first += kAtOnce) {
        const std::size_t count = std::min(kAtOnce, directions.size() - first);
        for (std::size_t k = 0; k < count; ++k) {
            starts[k] = from.hit;
            turned_directions[k] = within(from, directions[first + k]);
        }
        relief_->surface->occluded(std::span(starts).first(count), std::span(turned_directions).first(count),
                                   hidden.subspan(first, count), std::span(ways_out).first(count));
    }
}

void ReliefPoint::hides(std::span<const glm::vec3> directions, std::span<std::uint8_t> hidden) const {
    surfaces->hides(*this, directions, hidden);
}

bool ReliefPoint::hides(const glm::vec3& direction) const {
    std::uint8_t hidden = 0;
    hides({&direction, 1}, {&hidden, 1});
    return hidden != 0;
}

bool ReliefSurfaces::meets(const ReliefPoint& from, const glm::vec3& direction, CameraHit& next) const {
    const glm::vec3 inner = within(from, direction);
    SurfaceHit hit;
    relief_->surface->trace_on({&from.hit, 1}, {&inner, 1}, {&hit, 1});
    if (!hit.found())
        return false;
    next = met(hit, direction);
    return true;
}

std::span<const CameraHit> RowHits::of_pixel(int x) {
    const int samples = options_.samples;
    if (x >= end_ || x < first_) {
        first_ = x;
        end_ = std::min(options_.width, x + std::max(1, kRaysAhead / samples));
        hits_.resize(std::size_t(end_ - first_) * std::size_t(samples));
        for (int pixel = first_; pixel < end_; ++pixel) {
            const PixelRays rays(frame_, options_, pixel, y_);
            for (int s = 0; s < samples; ++s)
                hits_[std::size_t(pixel - first_) * std::size_t(samples) + std::size_t(s)].direction =
                    rays.direction(std::uint32_t(s));
        }
        surfaces_.first_hits(hits_);
    }
    return std::span(hits_).subspan(std::size_t(x - first_) * std::size_t(samples), std::size_t(samples));
}

} // namespace kokage
