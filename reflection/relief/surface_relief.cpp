#include "reflection/relief/surface_relief.h"
#include "reflection/relief/shell_step.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace kokage {

using Prism = ReliefShell::Prism;

/// A ray on its way through the shell. Distances s count from `origin`, so that they stay small.
struct SurfaceRelief::Walk {
    enum class State : std::uint8_t {
        going,
        hit,     ///< relief within the tetrahedron
        stopped, ///< at a solid prism
        left,
    } state = State::going;
    glm::dvec3 origin{0.}, direction{0.};
    double s = 0, strength = 1;
    std::uint32_t prism = 0, tetrahedron = 0, entry = kNoEntry, tetrahedra = 0, reads = 0;
    ShellSegment segment;
    double depth = 0; ///< of the hit, of the shell's
    glm::dvec2 slope{0.};
};

namespace {

constexpr std::size_t kBlock = 2048; ///< rays that are followed together: enough for vector code, few enough for caches

glm::dvec3 triangle_normal(const ReliefShell& shell, const Prism& prism) {
    const glm::dvec3 o(shell.outer[prism.places[0]]);
    const glm::dvec3 n =
        glm::cross(glm::dvec3(shell.outer[prism.places[1]]) - o, glm::dvec3(shell.outer[prism.places[2]]) - o);
    const bool odd = (prism.corners[1] + 3 - prism.corners[0]) % 3 != 1;
    return odd ? -n : n;
}

/// Weights of the prism's corners at the point of its triangle that is nearest to a point near it.
glm::dvec3 weights_on_triangle(const ReliefShell& shell, const Prism& prism, const glm::dvec3& point) {
    const glm::dvec3 o(shell.outer[prism.places[0]]), a = glm::dvec3(shell.outer[prism.places[1]]) - o,
                                                      b = glm::dvec3(shell.outer[prism.places[2]]) - o, p = point - o;
    const glm::dvec3 n = glm::cross(a, b);
    const double squared = glm::dot(n, n);
    if (!(squared > 0))
        return glm::dvec3(1. / 3);
    glm::dvec3 w(0., glm::dot(glm::cross(p, b), n) / squared, glm::dot(glm::cross(a, p), n) / squared);
    w.x = 1 - w.y - w.z;
    w = glm::clamp(w, 0., 1.);
    return w / (w.x + w.y + w.z);
}

glm::vec3 to_triangle_corners(const Prism& prism, const glm::dvec3& weights) {
    glm::vec3 result(0.f);
    for (std::size_t k = 0; k < 3; ++k)
        result[prism.corners[k]] = float(weights[k]);
    return result;
}

glm::vec3 unit_or(const glm::dvec3& v, const glm::vec3& otherwise) {
    const double length = glm::length(v);
    return length > 0 && std::isfinite(length) ? glm::vec3(v / length) : otherwise;
}

ReliefRay relief_ray_of(const ShellSegment& segment, double start, double strength) {
    const glm::dvec3 at = segment.at + start * segment.step;
    const glm::dvec2 tile(std::floor(at.x), std::floor(at.y));
    return {{float(at.x - tile.x), float(at.y - tile.y), float(at.z / strength)},
            {float(segment.step.x), float(segment.step.y), float(segment.step.z / strength)},
            float(segment.end - start)};
}

} // namespace

float relief_strength(float pixels) {
    const float x = std::clamp((pixels - 0.25f) / 0.5f, 0.f, 1.f);
    return x * x * (3 - 2 * x);
}

SurfaceRelief::SurfaceRelief(const ReliefShell& shell, const TangentFrames& frames,
                             std::vector<SurfaceReliefLayer> layers)
    : shell_(shell), frames_(frames), layers_(std::move(layers)) {
    for (const Prism& prism : shell.prisms)
        if (!prism.is_solid && (prism.layer >= layers_.size() || !layers_[prism.layer].tracer))
            throw std::invalid_argument("relief: layer " + std::to_string(prism.layer) + " has no tracer");
}

SurfaceRelief::SurfaceRelief(const ReliefShell& shell, const TangentFrames& frames, const ReliefTracer& tracer)
    : SurfaceRelief(shell, frames, {{&tracer, 0}}) {}

namespace {

/// Takes a walk that hit nothing in its tetrahedron to what lies behind it.
template <class Walk>
void cross(Walk& walk, const ReliefShell& shell) {
    using State = typename Walk::State;
    const ShellCrossing& crossing = kCrossings[walk.tetrahedron][walk.segment.exit];
    walk.s = walk.segment.end;
    switch (crossing.kind) {
    case ShellCrossing::Kind::within:
        walk.tetrahedron = crossing.tetrahedron;
        walk.entry = crossing.entry;
        return;
    case ShellCrossing::Kind::outside:
        walk.state = State::left;
        return;
    case ShellCrossing::Kind::bottom: // relief reaches down to depth 1 at most: by rounding only
        walk.state = State::hit;
        walk.depth = walk.strength;
        return;
    case ShellCrossing::Kind::side: {
        const std::uint32_t neighbor = shell.prisms[walk.prism].neighbors[crossing.side];
        if (neighbor == ReliefShell::kBorder) {
            walk.state = State::left;
            return;
        }
        walk.prism = neighbor >> 2;
        const SideEntry& entry = kSideEntries[neighbor & 3][crossing.is_upper ? 1 : 0];
        walk.tetrahedron = entry.tetrahedron;
        walk.entry = entry.entry;
        if (shell.prisms[walk.prism].is_solid)
            walk.state = State::stopped;
        return;
    }
    }
}

} // namespace

/// The rays of one layer that are traced at once.
struct SurfaceRelief::Wave {
    const SurfaceReliefLayer* layer = nullptr;
    std::vector<std::uint32_t> traced;
    std::vector<ReliefRay> rays;
    std::vector<ReliefHit> hits;

    void take(std::uint32_t i, const Walk& w) {
        const double deepest = w.segment.at.z + w.segment.step.z * (w.segment.step.z > 0 ? w.segment.end : w.s);
        if (deepest < w.strength * double(layer->least_depth) - 1e-6)
            return;
        traced.push_back(i);
        rays.push_back(relief_ray_of(w.segment, w.s, w.strength));
    }
};

void SurfaceRelief::step(Wave& wave, std::vector<Walk>& walks) const {
    wave.hits.assign(wave.rays.size(), {});
    wave.layer->tracer->trace(wave.rays, wave.hits);
    for (std::size_t k = 0; k < wave.traced.size(); ++k) {
        Walk& w = walks[wave.traced[k]];
        const ReliefHit& hit = wave.hits[k];
        w.reads += hit.reads;
        if (!hit.found())
            continue;
        w.state = Walk::State::hit;
        w.s = std::min(w.s + double(hit.t), w.segment.end);
        w.depth = double(hit.depth) * w.strength;
        w.slope = glm::dvec2(hit.slope) * w.strength;
    }
    wave.traced.clear();
    wave.rays.clear();
}

void SurfaceRelief::follow(std::vector<Walk>& walks) const {
    const std::uint32_t most = std::uint32_t(std::min<std::size_t>(3 * shell_.prisms.size() + 16, 1u << 20));
    // Kept from call to call: for single rays, making them anew takes as long as tracing.
    thread_local std::vector<std::uint32_t> going;
    thread_local std::vector<Wave> waves;
    going.clear();
    waves.resize(std::max(waves.size(), layers_.size()));
    for (std::size_t l = 0; l < layers_.size(); ++l) {
        waves[l].layer = &layers_[l];
        waves[l].traced.clear();
        waves[l].rays.clear();
    }
    for (std::uint32_t i = 0; i < walks.size(); ++i)
        if (walks[i].state == Walk::State::going)
            going.push_back(i);
    while (!going.empty()) {
        for (const std::uint32_t i : going) {
            Walk& w = walks[i];
            w.segment = shell_segment(shell_, w.prism, w.tetrahedron, w.entry, w.origin, w.direction, w.s);
            ++w.tetrahedra;
            waves[shell_.prisms[w.prism].layer].take(i, w);
        }
        for (std::size_t l = 0; l < layers_.size(); ++l)
            if (!waves[l].rays.empty())
                step(waves[l], walks);
        std::erase_if(going, [&](std::uint32_t i) {
            if (walks[i].state == Walk::State::going)
                cross(walks[i], shell_);
            if (walks[i].tetrahedra >= most)
                walks[i].state = Walk::State::left;
            return walks[i].state != Walk::State::going;
        });
    }
}

SurfaceHit SurfaceRelief::hit_of(const Walk& walk, const SurfaceRay& ray) const {
    SurfaceHit hit;
    const double distance = double(ray.distance) + walk.s;
    hit.way_out = float(distance);
    hit.strength = float(walk.strength);
    hit.reads = walk.reads;
    hit.tetrahedra = walk.tetrahedra;
    hit.triangle = walk.prism;
    if (walk.state == Walk::State::left)
        return hit;
    const Prism& prism = shell_.prisms[walk.prism];
    const glm::dvec3 point = walk.origin + walk.s * walk.direction;
    const bool is_relief = walk.state == Walk::State::hit;
    glm::dvec3 weights = is_relief ? walk.segment.weights + walk.s * walk.segment.weights_step
                                   : weights_on_triangle(shell_, prism, point);
    weights = glm::max(weights, 0.);
    weights /= weights.x + weights.y + weights.z;
    hit.distance = float(distance);
    hit.position = glm::vec3(point);
    hit.weights = to_triangle_corners(prism, weights);
    for (std::size_t k = 0; k < 3; ++k)
        hit.uv += float(weights[k]) * prism.uvs[k];
    const TangentFrame frame = interpolate(frames_, walk.prism, hit.weights);
    hit.shading_normal = frame.normal;
    hit.geometric_normal = unit_or(triangle_normal(shell_, prism), frame.normal);
    if (frame.normal == glm::vec3(0.f)) // a mesh with normals of no length
        hit.shading_normal = hit.geometric_normal;
    if (!is_relief)
        return hit;
    hit.thickness_m = shell_.thickness_m(prism, glm::vec3(weights));
    hit.depth = float(walk.depth);
    hit.depth_m = hit.depth * hit.thickness_m;
    hit.shading_normal = relief_normal(frame, glm::vec2(walk.slope), hit.thickness_m);
    // The surface is where depth - relief(u, v) is 0; it grows inwards.
    hit.geometric_normal = unit_or(walk.slope.x * walk.segment.gradient_u + walk.slope.y * walk.segment.gradient_v -
                                       walk.segment.gradient_depth,
                                   hit.geometric_normal);
    return hit;
}

SurfaceRelief::Walk SurfaceRelief::from_outside(const SurfaceRay& ray) const {
    Walk w;
    w.direction = glm::dvec3(ray.direction);
    w.origin = glm::dvec3(ray.origin) + double(ray.distance) * w.direction;
    w.strength = double(ray.strength);
    w.prism = ray.triangle;
    w.entry = 3; // through a0 a1 a2 of the first tetrahedron
    const Prism& prism = shell_.prisms[w.prism];
    if (prism.is_solid || !(w.strength > 0) || !(glm::dot(triangle_normal(shell_, prism), w.direction) < 0))
        w.state = Walk::State::stopped;
    return w;
}

SurfaceRelief::Walk SurfaceRelief::from_hit(const SurfaceHit& hit, const glm::vec3& direction) const {
    Walk w;
    w.prism = hit.triangle;
    w.direction = glm::dvec3(direction);
    w.origin = glm::dvec3(hit.position);
    w.strength = double(hit.strength);
    if (!hit.found() || hit.thickness_m <= 0) { // the mesh itself hides what is behind it
        const bool is_behind = glm::dot(hit.geometric_normal, direction) <= 0;
        w.state = is_behind && hit.found() ? Walk::State::stopped : Walk::State::left;
        return w;
    }
    const Prism& prism = shell_.prisms[w.prism];
    glm::dvec3 weights;
    for (std::size_t k = 0; k < 3; ++k)
        weights[k] = double(hit.weights[prism.corners[k]]);
    const double depth = double(hit.depth) - double(kShadowLift) * w.strength;
    w.tetrahedron = depth <= weights.z ? 0 : depth <= weights.z + weights.y ? 1 : 2;
    w.origin = shell_point(shell_, prism, weights, depth);
    return w;
}

void SurfaceRelief::trace(std::span<const SurfaceRay> rays, std::span<SurfaceHit> hits) const {
    thread_local std::vector<Walk> walks;
    for (std::size_t first = 0; first < rays.size(); first += kBlock) {
        const std::size_t end = std::min(rays.size(), first + kBlock);
        walks.clear();
        for (std::size_t i = first; i < end; ++i)
            walks.push_back(from_outside(rays[i]));
        follow(walks);
        for (std::size_t i = first; i < end; ++i)
            hits[i] = hit_of(walks[i - first], rays[i]);
    }
}

void SurfaceRelief::occluded(std::span<const SurfaceHit> hits, std::span<const glm::vec3> to_light,
                             std::span<std::uint8_t> hidden, std::span<float> ways_out) const {
    thread_local std::vector<Walk> walks;
    for (std::size_t first = 0; first < hits.size(); first += kBlock) {
        const std::size_t end = std::min(hits.size(), first + kBlock);
        walks.clear();
        for (std::size_t i = first; i < end; ++i)
            walks.push_back(from_hit(hits[i], to_light[i]));
        follow(walks);
        for (std::size_t i = first; i < end; ++i) {
            const Walk& w = walks[i - first];
            hidden[i] = w.state == Walk::State::hit || w.state == Walk::State::stopped;
            ways_out[i] = float(w.s);
        }
    }
}

void SurfaceRelief::trace_on(std::span<const SurfaceHit> from, std::span<const glm::vec3> directions,
                             std::span<SurfaceHit> hits) const {
    thread_local std::vector<Walk> walks;
    for (std::size_t first = 0; first < from.size(); first += kBlock) {
        const std::size_t end = std::min(from.size(), first + kBlock);
        walks.clear();
        for (std::size_t i = first; i < end; ++i)
            walks.push_back(from_hit(from[i], directions[i]));
        follow(walks);
        for (std::size_t i = first; i < end; ++i)
            hits[i] = hit_of(walks[i - first], SurfaceRay{from[i].position, directions[i], from[i].triangle, 0, 1});
    }
}

} // namespace kokage
