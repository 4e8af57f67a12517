#include "reflection/maps/glossy_picture.h"

#include "common/services/error.h"
#include "common/services/parallel.h"
#include "reflection/maps/lat_long_sums.h"

#include <cmath>
#include <limits>

namespace kokage {

GlossyObject glossy_object(const MeshScene& scene, bool z_up) {
    GlossyObject object;
    const auto turned = [&](const glm::vec3& v) { return z_up ? glm::vec3(v.x, v.z, -v.y) : v; };
    PatchScene& patches = object.patches;
    for (const SceneMesh& mesh : scene.meshes) {
        const std::uint32_t first = std::uint32_t(patches.positions.size());
        for (const glm::vec3& position : mesh.positions)
            patches.positions.push_back(turned(position));
        for (const glm::vec3& normal : mesh.normals)
            object.normals.push_back(turned(normal));
        for (const glm::uvec3& triangle : mesh.triangles)
            patches.triangles.push_back(triangle + first);
    }
    if (patches.triangles.empty())
        throw InputError("the scene has no triangles: nothing can reflect");
    patches.triangle_patch.assign(patches.triangles.size(), 0);
    patches.patches.push_back({0, std::uint32_t(patches.triangles.size()), 0, PatchKind::bark, 0});
    patches.optics.emplace_back();
    return object;
}

namespace {

struct CameraRays {
    glm::vec3 position, ahead, right, down; ///< right and down: of a pixel
    CameraRays(const Camera& camera, int width, int height) : position(camera.position) {
        const glm::vec3 forward = glm::normalize(camera.target - camera.position);
        const glm::vec3 side = glm::normalize(glm::cross(forward, camera.up));
        const float pixel = 2 * std::tan(0.5f * camera.vertical_field_of_view) / float(height);
        right = pixel * side;
        down = pixel * glm::cross(forward, side);
        ahead = forward + 0.5f * (1 - float(width)) * right + 0.5f * (1 - float(height)) * down;
    }
    glm::vec3 direction(int x, int y) const { return glm::normalize(ahead + float(x) * right + float(y) * down); }
};

void add_pixel(const GlossyObject& object, const RayHit& hit, const glm::vec3& ray, std::uint32_t pixel,
               SurfacePixels& pixels) {
    const glm::uvec3 corner = object.patches.triangles[hit.triangle];
    const glm::vec2 b = hit.barycentric;
    const auto blend = [&](const std::vector<glm::vec3>& values) {
        return (1 - b.x - b.y) * values[corner[0]] + b.x * values[corner[1]] + b.y * values[corner[2]];
    };
    glm::vec3 normal = blend(object.normals);
    const float length = glm::length(normal);
    normal = length > 0 ? normal / length : hit.geometric_normal;
    pixels.pixel.push_back(pixel);
    pixels.triangle.push_back(hit.triangle);
    pixels.barycentric.push_back(b);
    pixels.position.push_back(blend(object.patches.positions));
    pixels.normal.push_back(normal);
    pixels.mirrored.push_back(glm::normalize(ray - 2 * glm::dot(normal, ray) * normal));
}

} // namespace

SurfacePixels surface_in_view(const GlossyObject& object, const Camera& camera, int width, int height) {
    const RayQueries queries(object.patches);
    const CameraRays rays(camera, width, height);
    std::vector<SurfacePixels> rows(static_cast<std::size_t>(height));
    parallel_blocks(rows.size(), 8, [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y)
            for (int x = 0; x < width; ++x) {
                RayHit hit;
                const glm::vec3 direction = rays.direction(x, int(y));
                if (queries.first_hit(rays.position, direction, 0, std::numeric_limits<float>::infinity(), hit))
                    add_pixel(object, hit, direction, std::uint32_t(y) * std::uint32_t(width) + std::uint32_t(x),
                              rows[y]);
            }
    });
    SurfacePixels all;
    all.width = width;
    all.height = height;
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    for (const SurfacePixels& row : rows) {
        append(all.pixel, row.pixel);
        append(all.triangle, row.triangle);
        append(all.barycentric, row.barycentric);
        append(all.position, row.position);
        append(all.normal, row.normal);
        append(all.mirrored, row.mirrored);
    }
    return all;
}

std::vector<glm::vec3> reflected_by_brute_force(const SurfacePixels& pixels, LobeKind kind,
                                                std::span<const float> parameters, const Image& surroundings,
                                                Progress& progress) {
    LatLongPlanes planes(surroundings.width, surroundings.height);
    planes.set_pixels(surroundings);
    std::vector<glm::vec3> values(pixels.size());
    progress.begin("reflecting by brute force", pixels.size());
    parallel_blocks(pixels.size(), 64, [&](std::size_t begin, std::size_t end) {
        progress.throw_if_stopped();
        for (std::size_t i = begin; i < end; ++i) {
            const Lobe lobe{kind, double(parameters[i])};
            const glm::dvec3 normal = glm::normalize(glm::dvec3(pixels.normal[i]));
            const glm::dvec3 mirrored = glm::normalize(glm::dvec3(pixels.mirrored[i]));
            const LobeSums sums = sum_over_lobe(planes, lobe, mirrored, lobe_reach(lobe, 1e-12), 0, &normal);
            // The sum of the weights is the full mass times the peak wherever the image resolves the lobe.
            values[i] = sums.weight > 0 ? glm::vec3(sums.radiance / sums.weight) : glm::vec3(0.f);
        }
        progress.advance(end - begin);
    });
    return values;
}

std::vector<glm::vec3> reflected_from_map(const SurfacePixels& pixels, std::span<const float> parameters,
                                          const MapLookup& look_up, const HorizonTable& horizon) {
    std::vector<glm::vec3> values(pixels.size());
    parallel_blocks(pixels.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            values[i] =
                filtered_above_horizon(horizon, pixels.normal[i], pixels.mirrored[i], double(parameters[i]), look_up);
    });
    return values;
}

Image picture_of(const SurfacePixels& pixels, std::span<const glm::vec3> values, const glm::vec3& background) {
    Image image(pixels.width, pixels.height, 3);
    const auto set = [&](std::size_t pixel, const glm::vec3& value) {
        for (int c = 0; c < 3; ++c)
            image.pixels[3 * pixel + std::size_t(c)] = value[std::size_t(c)];
    };
    for (std::size_t i = 0; i < image.pixels.size() / 3; ++i)
        set(i, background);
    for (std::size_t i = 0; i < pixels.size(); ++i)
        set(pixels.pixel[i], values[i]);
    return image;
}

} // namespace kokage
