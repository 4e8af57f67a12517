// Embree 3 (Wald et al. 2014, "Embree: a kernel framework for efficient CPU ray tracing") behind our own interface.
//
// Embree works in a frame of its own: the scene's box is moved to the origin and scaled to a largest side of 1, so that
// a tree of 1e-6 m and one of 1e6 m give the same bits. Solid and masked triangles are two geometries: only the masked
// one pays for the filter that looks the texel up. The structure is built on one thread, because its order decides
// between coincident triangles.
#include "common/trace/ray_queries.h"
#include "common/services/error.h"
#include "common/trace/ground_plane.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <embree3/rtcore.h>
#include <optional>
#include <string>
#include <tbb/task_arena.h>

namespace kokage {
namespace {

/// Thirty-two units in the last place of the largest coordinate: rounding of hit points stays well below it.
constexpr float kOffsetUlps = 32 * 0x1p-23f;

bool degenerate(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const glm::vec3 normal = glm::cross(b - a, c - a);
    const float squared = glm::dot(normal, normal);
    return !(squared > 1e-36f) || !std::isfinite(squared); // below: its normal is rounding
}

/// The uv of a hit decides: false makes Embree go on to the next candidate.
void reject_holes(const RTCFilterFunctionNArguments* arguments);

} // namespace

struct RayQueries::Implementation {
    const PatchScene* scene = nullptr;
    RTCDevice device = nullptr;
    RTCScene embree_scene = nullptr; ///< null when there is nothing to hit but the ground
    glm::dvec3 centre{0.0};
    double scale = 1; ///< normalised = (world - centre) * scale
    glm::vec3 centre_float{0.f};
    float scale_float = 1, inverse_scale = 1, offset = 0;
    std::optional<GroundPlane> ground;
    std::vector<std::uint32_t> triangles[2]; ///< scene's triangle of each primitive; geometry 0: solid, 1: masked
    std::atomic<std::ptrdiff_t> bytes{0};

    explicit Implementation(const PatchScene& s) : scene(&s) {
        set_frame();
        sort_triangles();
        if (triangles[0].empty() && triangles[1].empty())
            return;
        device = rtcNewDevice(std::getenv("KOKAGE_EMBREE"));
        if (!device)
            throw std::runtime_error("Embree could not start: error " +
                                     std::to_string(int(rtcGetDeviceError(nullptr))));
        rtcSetDeviceMemoryMonitorFunction(device, &count_bytes, this);
        embree_scene = rtcNewScene(device);
        rtcSetSceneFlags(embree_scene, RTC_SCENE_FLAG_ROBUST);
        rtcSetSceneBuildQuality(embree_scene, RTC_BUILD_QUALITY_MEDIUM);
        for (unsigned geometry : {0u, 1u})
            if (!triangles[geometry].empty())
                add_geometry(geometry);
        tbb::task_arena(1).execute([&] { rtcCommitScene(embree_scene); });
        if (const RTCError error = rtcGetDeviceError(device); error != RTC_ERROR_NONE)
            throw std::runtime_error("Embree could not build its structure: error " + std::to_string(int(error)));
    }
    ~Implementation() {
        if (embree_scene)
            rtcReleaseScene(embree_scene);
        if (device)
            rtcReleaseDevice(device);
    }

    static bool count_bytes(void* self, ssize_t change, bool) {
        static_cast<Implementation*>(self)->bytes += change;
        return true;
    }

    void set_frame() {
        const Bounds bounds = bounds_of(*scene);
        const glm::dvec3 low(bounds.low), high(bounds.high), size = high - low;
        const double largest = std::max({size.x, size.y, size.z});
        centre = low + 0.5 * size;
        scale = largest > 0 ? 1 / largest : 1;
        double reach = 0;
        for (std::size_t k = 0; k < 3; ++k)
            reach = std::max({reach, std::abs(low[k]), std::abs(high[k])});
        if (scene->ground)
            reach = std::max(reach, std::abs(double(scene->ground->height_m)));
        centre_float = glm::vec3(centre);
        centre = glm::dvec3(centre_float); // rays subtract the rounded centre: triangles must too
        scale_float = float(scale);
        scale = double(scale_float);
        inverse_scale = float(1 / scale);
        offset = std::max(float(reach) * kOffsetUlps, 1e-30f);
        if (scene->ground)
            ground.emplace(scene->ground->height_m, offset);
    }

    void sort_triangles() {
        for (std::size_t t = 0; t < scene->triangles.size(); ++t) {
            const glm::uvec3& corners = scene->triangles[t];
            if (!degenerate(normalised(corners.x), normalised(corners.y), normalised(corners.z)))
                triangles[scene->masked(t) ? 1 : 0].push_back(std::uint32_t(t));
        }
    }

    glm::vec3 normalised(std::uint32_t position) const {
        return glm::vec3((glm::dvec3(scene->positions[position]) - centre) * scale);
    }

    void add_geometry(unsigned id) {
        RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        // Only positions that this geometry uses, in order of first use.
        std::vector<std::uint32_t> place(scene->positions.size(), ~0u), used;
        for (std::uint32_t t : triangles[id])
            for (std::size_t k = 0; k < 3; ++k) {
                std::uint32_t& where = place[scene->triangles[t][k]];
                if (where == ~0u) {
                    where = std::uint32_t(used.size());
                    used.push_back(scene->triangles[t][k]);
                }
            }
        auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), used.size()));
        auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), triangles[id].size()));
        if (!vertices || !indices) {
            rtcReleaseGeometry(geometry);
            throw std::bad_alloc();
        }
        for (std::size_t i = 0; i < used.size(); ++i)
            for (std::size_t k = 0; k < 3; ++k)
                vertices[3 * i + k] = normalised(used[i])[k];
        for (std::size_t i = 0; i < triangles[id].size(); ++i)
            for (std::size_t k = 0; k < 3; ++k)
                indices[3 * i + k] = place[scene->triangles[triangles[id][i]][k]];
        if (id == 1) {
            rtcSetGeometryUserData(geometry, this);
            rtcSetGeometryIntersectFilterFunction(geometry, &reject_holes);
            rtcSetGeometryOccludedFilterFunction(geometry, &reject_holes);
        }
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(embree_scene, geometry, id);
        rtcReleaseGeometry(geometry);
    }

    bool solid(std::uint32_t primitive, float u, float v) const {
        const std::uint32_t t = triangles[1][primitive];
        const glm::uvec3& corners = scene->triangles[t];
        const glm::vec2 uv =
            (1 - u - v) * scene->uvs[corners.x] + u * scene->uvs[corners.y] + v * scene->uvs[corners.z];
        return scene->masks[std::size_t(scene->triangle_mask[t])].solid(uv);
    }

    /// Embree's ray in the normalised frame. Embree takes tnear >= 0.
    RTCRay ray(const glm::vec3& origin, const glm::vec3& direction, float near, float far) const {
        const glm::vec3 start = (origin - centre_float) * scale_float;
        RTCRay result;
        result.org_x = start.x, result.org_y = start.y, result.org_z = start.z;
        result.dir_x = direction.x, result.dir_y = direction.y, result.dir_z = direction.z;
        result.tnear = std::max(0.f, near * scale_float);
        result.tfar = far * scale_float;
        result.time = 0, result.mask = ~0u, result.id = 0, result.flags = 0;
        return result;
    }

    /// The answer for a hit of Embree's.
    RayHit hit_of(unsigned geometry, unsigned primitive, float distance, glm::vec2 uv, const glm::vec3& normal) const {
        return {distance * inverse_scale, triangles[geometry][primitive], uv, glm::normalize(normal), false};
    }

    /// Distance to the ground plane along a ray; infinite if it is not met in (near, far).
    float ground_distance(const glm::vec3& origin, const glm::vec3& direction, float near, float far) const {
        const float distance = ground ? ground->distance(origin, direction) : INFINITY;
        return distance > near && distance < far ? distance : INFINITY;
    }
    /// How far a ray is to look for surfaces that lie before the ground, or on it.
    float surface_distance(float ground_distance, const glm::vec3& direction, float far) const {
        return ground ? std::min(far, ground->distance_to_surfaces(ground_distance, direction)) : far;
    }
};

namespace {

void reject_holes(const RTCFilterFunctionNArguments* arguments) {
    const auto& queries = *static_cast<const RayQueries::Implementation*>(arguments->geometryUserPtr);
    for (unsigned i = 0; i < arguments->N; ++i)
        if (arguments->valid[i] == -1 &&
            !queries.solid(RTCHitN_primID(arguments->hit, arguments->N, i), RTCHitN_u(arguments->hit, arguments->N, i),
                           RTCHitN_v(arguments->hit, arguments->N, i)))
            arguments->valid[i] = 0;
}

constexpr std::size_t kPacket = 16;

/// As many rays as Embree takes together; those that were not set are left alone. Where the machine has no packets as
/// wide, Embree splits them and asks only the rays themselves which of them are to be traced: those that end before
/// they begin are not, and no number of theirs may be left to chance.
struct RayPacket {
    alignas(64) int valid[kPacket] = {};
    RTCRayHit16 query = {};
    RTCIntersectContext context;

    RayPacket() {
        std::fill_n(query.ray.tfar, kPacket, -1.f);
        rtcInitIntersectContext(&context);
        context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    }
    void set(std::size_t k, const RTCRay& ray) {
        valid[k] = -1;
        query.ray.org_x[k] = ray.org_x, query.ray.org_y[k] = ray.org_y, query.ray.org_z[k] = ray.org_z;
        query.ray.dir_x[k] = ray.dir_x, query.ray.dir_y[k] = ray.dir_y, query.ray.dir_z[k] = ray.dir_z;
        query.ray.tnear[k] = ray.tnear, query.ray.tfar[k] = ray.tfar;
        query.ray.time[k] = 0, query.ray.mask[k] = ~0u, query.ray.id[k] = 0, query.ray.flags[k] = 0;
        query.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
        query.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
    }
};

} // namespace

RayQueries::RayQueries(const PatchScene& scene) : implementation_(std::make_unique<Implementation>(scene)) {}
RayQueries::~RayQueries() = default;
RayQueries::RayQueries(RayQueries&&) noexcept = default;
RayQueries& RayQueries::operator=(RayQueries&&) noexcept = default;

bool RayQueries::first_hit(const glm::vec3& origin, const glm::vec3& direction, float near, float far,
                           RayHit& hit) const {
    const Implementation& self = *implementation_;
    const float ground = self.ground_distance(origin, direction, near, far);
    if (self.embree_scene) {
        RTCRayHit query;
        query.ray = self.ray(origin, direction, near, self.surface_distance(ground, direction, far));
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect1(self.embree_scene, &context, &query);
        if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
            hit = self.hit_of(query.hit.geomID, query.hit.primID, query.ray.tfar, {query.hit.u, query.hit.v},
                              {query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z});
            return true;
        }
    }
    if (ground == INFINITY)
        return false;
    hit = {ground, 0, glm::vec2(0), glm::vec3(0, 1, 0), true};
    return true;
}

bool RayQueries::occluded(const glm::vec3& origin, const glm::vec3& direction, float near, float far) const {
    const Implementation& self = *implementation_;
    if (self.ground_distance(origin, direction, near, far) != INFINITY)
        return true;
    if (!self.embree_scene)
        return false;
    RTCRay query = self.ray(origin, direction, near, far);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(self.embree_scene, &context, &query);
    return query.tfar < 0;
}

void RayQueries::first_hits(std::span<const Ray> rays, std::span<RayHit> hits, std::span<std::uint8_t> found) const {
    const Implementation& self = *implementation_;
    for (std::size_t first = 0; first < rays.size(); first += kPacket) {
        const std::size_t count = std::min(kPacket, rays.size() - first);
        RayPacket packet;
        float ground[kPacket];
        for (std::size_t k = 0; k < count; ++k) {
            const Ray& ray = rays[first + k];
            ground[k] = self.ground_distance(ray.origin, ray.direction, ray.near, ray.far);
            packet.set(k, self.ray(ray.origin, ray.direction, ray.near,
                                   self.surface_distance(ground[k], ray.direction, ray.far)));
        }
        if (self.embree_scene)
            rtcIntersect16(packet.valid, self.embree_scene, &packet.context, &packet.query);
        for (std::size_t k = 0; k < count; ++k) {
            const RTCHit16& hit = packet.query.hit;
            found[first + k] = true;
            if (hit.geomID[k] != RTC_INVALID_GEOMETRY_ID)
                hits[first + k] = self.hit_of(hit.geomID[k], hit.primID[k], packet.query.ray.tfar[k],
                                              {hit.u[k], hit.v[k]}, {hit.Ng_x[k], hit.Ng_y[k], hit.Ng_z[k]});
            else if (ground[k] < INFINITY)
                hits[first + k] = {ground[k], 0, glm::vec2(0), glm::vec3(0, 1, 0), true};
            else
                found[first + k] = false;
        }
    }
}

void RayQueries::occluded(std::span<const Ray> rays, std::span<std::uint8_t> hidden) const {
    const Implementation& self = *implementation_;
    for (std::size_t first = 0; first < rays.size(); first += kPacket) {
        const std::size_t count = std::min(kPacket, rays.size() - first);
        RayPacket packet;
        for (std::size_t k = 0; k < count; ++k) {
            const Ray& ray = rays[first + k];
            hidden[first + k] = self.ground_distance(ray.origin, ray.direction, ray.near, ray.far) != INFINITY;
            if (!hidden[first + k])
                packet.set(k, self.ray(ray.origin, ray.direction, ray.near, ray.far));
        }
        if (!self.embree_scene)
            continue;
        rtcOccluded16(packet.valid, self.embree_scene, &packet.context, &packet.query.ray);
        for (std::size_t k = 0; k < count; ++k)
            if (packet.valid[k])
                hidden[first + k] = packet.query.ray.tfar[k] < 0;
    }
}

float RayQueries::ray_offset() const {
    return implementation_->offset;
}
const PatchScene& RayQueries::scene() const {
    return *implementation_->scene;
}
std::size_t RayQueries::bytes() const {
    return std::size_t(std::max<std::ptrdiff_t>(0, implementation_->bytes)) +
           sizeof(std::uint32_t) * (implementation_->triangles[0].size() + implementation_->triangles[1].size());
}

} // namespace kokage
