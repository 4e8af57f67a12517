// Path tracing after Kajiya 1986 with next-event estimation for split-off lights, and one-sample multiple importance
// sampling (Veach 1997, section 9.2.4, balance heuristic) between the cosine lobe and the remainder's bright parts: a
// path's next direction is drawn from the mixture of both, so that no second shadow ray is needed.
#include "common/trace/path_tracer.h"
#include "common/environment/light_radiance.h"
#include "common/services/error.h"
#include "common/services/sharded_counter.h"
#include "common/trace/light_sampler.h"
#include "common/trace/remainder_sampler.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace kokage {
namespace {

/// Cosine-distributed direction around a unit normal: a point of the unit sphere added to it (Lambert's law seen as a
/// sphere that touches the surface). Exactly downward points are replaced by the normal.
glm::vec3 cosine_direction(const glm::vec3& normal, glm::vec2 numbers) {
    const float height = 1 - 2 * numbers.x, radius = std::sqrt(std::max(0.f, 1 - height * height));
    const float azimuth = 2 * kPi * numbers.y;
    const glm::vec3 sum = normal + glm::vec3(radius * std::cos(azimuth), height, radius * std::sin(azimuth));
    const float squared = glm::dot(sum, sum);
    return squared > 1e-8f ? sum / std::sqrt(squared) : normal;
}

/// A path's chance to go on is so many times the largest channel of its throughput. Measured in crowns of realistic and
/// of bright leaves: 1 costs 20 % more rays for the same error in bright ones, 3 costs 5 % more in realistic ones.
constexpr float kSurvival = 1.5f;

/// Remainders of less contrast than this are not sampled by importance.
constexpr double kLowContrast = 2.5;

float largest(const glm::vec3& colour) {
    return std::max({colour.r, colour.g, colour.b});
}

/// A place that scatters: what it sends back of light from the side of `normal`, and of light from the other side.
struct Vertex {
    glm::vec3 point, normal;
    glm::vec3 reflectance, transmittance;
};

} // namespace

struct PathTracer::Implementation {
    const RayQueries& queries;
    const PatchScene& scene;
    const Environment& environment;
    const PathTracerOptions options;
    const RemainderSampler remainder;
    const LightSampler lights;
    std::vector<std::uint32_t> triangle_optics;
    std::vector<Optics> optics;
    float remainder_share = 0;  ///< of directions that are drawn towards the remainder's bright parts
    float offset, exact_beyond; ///< metres
    mutable ShardedCounter rays;

    Implementation(const RayQueries& q, const Environment& e, PathTracerOptions o)
        : queries(q), scene(q.scene()), environment(e), options(std::move(o)), remainder(e.remainder), lights(e),
          optics(options.optics.empty() ? scene.optics : options.optics), offset(q.ray_offset()),
          exact_beyond(4 * bounds_of(scene).diagonal()) {
        if (optics.size() != scene.optics.size())
            throw InputError("path tracer: " + std::to_string(optics.size()) +
                             " optics were given for a scene that has " + std::to_string(scene.optics.size()));
        triangle_optics.reserve(scene.triangles.size());
        for (std::uint32_t patch : scene.triangle_patch)
            triangle_optics.push_back(scene.patches[patch].optics);
        // An even sky, also one whose lower half is black (contrast 2), is served best by the cosine lobe alone
        // (measured); a few bright spots gain from any share, and half of the paths stay for the rest.
        if (options.sample_remainder && remainder.contrast() > kLowContrast)
            remainder_share = 0.5f * (1 - std::sqrt(float(kLowContrast / remainder.contrast())));
    }

    bool below_ground(const glm::vec3& point) const {
        return scene.ground && point.y < scene.ground->height_m - offset;
    }

    bool visible(const glm::vec3& point, const glm::vec3& normal, const LightRay& ray) const {
        const glm::vec3 side = glm::dot(normal, ray.direction) > 0 ? normal : -normal;
        return !queries.occluded(point + offset * side, ray.direction, 0, ray.distance);
    }

    /// Irradiance from one light on each side of the vertex, weighted by what the vertex sends on of it.
    glm::vec3 light(const Vertex& vertex, PathNumbers& numbers, std::uint64_t& traced) const {
        if (lights.empty())
            return glm::vec3(0);
        const float choice = numbers.single();
        const glm::vec2 place = numbers.pair();
        const auto ray =
            lights.sample(vertex.point, vertex.normal, vertex.reflectance, vertex.transmittance, choice, place);
        if (!ray)
            return glm::vec3(0);
        const float cosine = glm::dot(vertex.normal, ray->direction);
        const glm::vec3 weight = cosine > 0 ? vertex.reflectance : vertex.transmittance;
        if (!(largest(weight) > 0))
            return glm::vec3(0);
        ++traced;
        return visible(vertex.point, vertex.normal, *ray) ? weight * ray->irradiance * std::abs(cosine) : glm::vec3(0);
    }

    /// Draws the next direction of a path and returns the factor by which the vertex' scattering over the density
    /// weighs it.
    glm::vec3 scatter(const Vertex& vertex, PathNumbers& numbers, glm::vec3& direction) const {
        const float reflected = vertex.reflectance.r + vertex.reflectance.g + vertex.reflectance.b;
        const float transmitted = vertex.transmittance.r + vertex.transmittance.g + vertex.transmittance.b;
        if (!(reflected + transmitted > 0))
            return glm::vec3(0);
        const float share = reflected / (reflected + transmitted);
        const float choice = transmitted > 0 || remainder_share > 0 ? numbers.single() : (numbers.skip(), 0.f);
        const glm::vec2 place = numbers.pair();
        if (choice < remainder_share) {
            direction = remainder.sample(place, choice / remainder_share).direction;
        } else {
            const bool back = (choice - remainder_share) / (1 - remainder_share) >= share;
            direction = cosine_direction(back ? -vertex.normal : vertex.normal, place);
            if (remainder_share == 0) // cosine / pi cancels
                return back ? vertex.transmittance / (1 - share) : vertex.reflectance / share;
        }
        const float cosine = glm::dot(vertex.normal, direction);
        const bool front = cosine > 0;
        const float lobe = (front ? share : 1 - share) * std::abs(cosine) / kPi;
        const float density = remainder_share * remainder.density(direction) + (1 - remainder_share) * lobe;
        return density > 0 ? (front ? vertex.reflectance : vertex.transmittance) * (std::abs(cosine) / (kPi * density))
                           : glm::vec3(0);
    }

    glm::vec3 point_on_triangle(const RayHit& hit) const {
        const glm::uvec3& corners = scene.triangles[hit.triangle];
        const glm::vec3 a = scene.positions[corners.x];
        return a + hit.barycentric.x * (scene.positions[corners.y] - a) +
               hit.barycentric.y * (scene.positions[corners.z] - a);
    }

    /// What a ray has hit, seen from where it came; false where nothing scatters (the ground's underside).
    bool vertex_at(const RayHit& hit, const glm::vec3& origin, const glm::vec3& direction, Vertex& vertex) const {
        if (hit.ground) {
            if (direction.y >= 0)
                return false;
            vertex.point = origin + hit.distance * direction;
            vertex.point.y = scene.ground->height_m;
            vertex.normal = {0, 1, 0};
            vertex.reflectance = scene.ground->albedo;
            vertex.transmittance = glm::vec3(0);
            return true;
        }
        // Along the ray, unless it is so long that its rounding would move the point off the triangle.
        vertex.point = hit.distance < exact_beyond ? origin + hit.distance * direction : point_on_triangle(hit);
        vertex.normal = glm::dot(hit.geometric_normal, direction) < 0 ? hit.geometric_normal : -hit.geometric_normal;
        const Optics& optic = optics[triangle_optics[hit.triangle]];
        vertex.reflectance = optic.reflectance;
        vertex.transmittance = optic.transmittance;
        return true;
    }

    struct PathLight {
        glm::vec3 total{0.f};
        Met first_met = Met::nothing;
    };

    /// Follows a path that leaves `origin` and gathers throughput x radiance. `unit` is a throughput that counts as 1
    /// in roulette.
    PathLight follow(glm::vec3 origin, glm::vec3 direction, glm::vec3 throughput, float unit, PathNumbers& numbers,
                     std::uint64_t& traced) const {
        PathLight result;
        for (int bounce = 0;; ++bounce) {
            RayHit hit;
            ++traced;
            const bool met = queries.first_hit(origin, direction, 0, INFINITY, hit);
            if (bounce == 0)
                result.first_met = !met ? Met::sky : hit.ground ? Met::ground : Met::patch;
            if (!met) {
                result.total += throughput * remainder.radiance(direction);
                break;
            }
            Vertex vertex;
            if ((options.max_bounces > 0 && bounce >= options.max_bounces) ||
                !vertex_at(hit, origin, direction, vertex))
                break;
            result.total += throughput * light(vertex, numbers, traced) / kPi;
            throughput *= scatter(vertex, numbers, direction);
            if (bounce >= options.roulette_after) {
                const float survival = std::min(0.99f, kSurvival * largest(throughput) / unit);
                if (!(numbers.independent() < survival))
                    break;
                throughput /= survival;
            }
            if (!(largest(throughput) > 0))
                break;
            origin = vertex.point + (glm::dot(vertex.normal, direction) > 0 ? offset : -offset) * vertex.normal;
        }
        return result;
    }

    /// Radiance of split-off lights that have an extent.
    glm::vec3 lights_seen(const glm::vec3& direction) const {
        glm::vec3 seen(0);
        for (const DistantLight& light : environment.distant_lights)
            seen += radiance_along(light, direction);
        return seen;
    }
};

PathTracer::PathTracer(const RayQueries& queries, const Environment& environment, PathTracerOptions options)
    : implementation_(std::make_unique<Implementation>(queries, environment, std::move(options))) {}
PathTracer::~PathTracer() = default;

PathTracer::IrradianceSample PathTracer::sample_irradiance(const glm::vec3& point, const glm::vec3& normal,
                                                           PathNumbers& numbers) const {
    const Implementation& self = *implementation_;
    IrradianceSample sample;
    if (self.below_ground(point))
        return sample;
    std::uint64_t traced = 0;
    // A receiver that takes all of its front's light: what it "reflects" is the irradiance.
    const Vertex receiver{point, normal, glm::vec3(1), glm::vec3(0)};
    sample.direct_from_lights = self.light(receiver, numbers, traced);
    const glm::vec3 weight = self.scatter(receiver, numbers, sample.path_direction);
    if (weight.x > 0) {
        const auto path =
            self.follow(point + self.offset * normal, sample.path_direction, kPi * weight, kPi, numbers, traced);
        sample.total = path.total;
        sample.from_patches = path.first_met == Met::patch ? path.total : glm::vec3(0);
        sample.path_weight = weight.x;
        sample.first_met = path.first_met;
    }
    sample.total += sample.direct_from_lights;
    self.rays.add(traced);
    return sample;
}

PathTracer::IrradianceSample PathTracer::sample_irradiance(const glm::vec3& point, const glm::vec3& normal,
                                                           Random& random) const {
    PathNumbers numbers(random);
    return sample_irradiance(point, normal, numbers);
}

glm::vec3 PathTracer::sample_radiance(const glm::vec3& origin, const glm::vec3& direction, Random& random) const {
    const Implementation& self = *implementation_;
    if (self.below_ground(origin))
        return glm::vec3(0);
    PathNumbers numbers(random);
    std::uint64_t traced = 0;
    const auto path = self.follow(origin, direction, glm::vec3(1), 1, numbers, traced);
    self.rays.add(traced);
    return path.total + (path.first_met == Met::sky ? self.lights_seen(direction) : glm::vec3(0));
}

std::uint64_t PathTracer::rays_traced() const {
    return implementation_->rays.total();
}

} // namespace kokage
