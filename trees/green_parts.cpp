#include "trees/green_parts.h"

#include "common/geometry/triangle_topology.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

double area_of(const SceneMesh& mesh, const glm::uvec3& t) {
    const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
    return 0.5 * glm::length(glm::cross(b - a, c - a));
}

/// The nearest texel, the texture repeated.
glm::vec3 texel(const Image& image, const glm::vec2& uv) {
    const auto place = [](float coordinate, int size) {
        return std::isfinite(coordinate)
                   ? std::clamp(int((coordinate - std::floor(coordinate)) * float(size)), 0, size - 1)
                   : 0;
    };
    const float* pixel = image.at(place(uv.x, image.width), place(uv.y, image.height));
    return {pixel[0], pixel[1], pixel[2]};
}

glm::vec3 color_of(const SceneMesh& mesh, const SceneMaterial& material, const glm::uvec3& t) {
    glm::vec3 color(material.base_color);
    if (material.base_color_texture && !mesh.uvs.empty())
        color *= texel(*material.base_color_texture->color, (mesh.uvs[t.x] + mesh.uvs[t.y] + mesh.uvs[t.z]) / 3.f);
    if (!mesh.colors.empty())
        color *= glm::vec3(mesh.colors[t.x] + mesh.colors[t.y] + mesh.colors[t.z]) / 3.f;
    return color;
}

} // namespace

bool is_green(const glm::vec3& color) {
    return color.g > 1.05f * color.r && color.g > 1.05f * color.b;
}

std::vector<bool> green_triangles(const SceneMesh& mesh, const SceneMaterial& material) {
    std::vector<bool> green(mesh.triangles.size());
    for (std::size_t t = 0; t < green.size(); ++t)
        green[t] = is_green(color_of(mesh, material, mesh.triangles[t]));
    const std::vector<std::uint32_t> piece =
        connected_components(triangle_neighbours(mesh.triangles, weld(mesh.positions)));
    const std::size_t pieces = piece.empty() ? 0 : std::size_t(*std::max_element(piece.begin(), piece.end())) + 1;
    if (pieces < 2)
        return green;
    std::vector<double> balance(pieces, 0.0);
    for (std::size_t t = 0; t < green.size(); ++t)
        balance[piece[t]] += (green[t] ? 1 : -1) * area_of(mesh, mesh.triangles[t]);
    for (std::size_t t = 0; t < green.size(); ++t)
        green[t] = balance[piece[t]] > 0;
    return green;
}

double green_share(const SceneMesh& mesh, const std::vector<bool>& green) {
    double sum = 0, all = 0;
    for (std::size_t t = 0; t < green.size(); ++t) {
        const double area = area_of(mesh, mesh.triangles[t]);
        sum += green[t] ? area : 0;
        all += area;
    }
    return all > 0 ? sum / all : 0;
}

SceneMesh take_triangles(SceneMesh& mesh, const std::vector<bool>& chosen) {
    SceneMesh taken = mesh;
    taken.triangles.clear();
    std::vector<glm::uvec3> kept;
    for (std::size_t t = 0; t < chosen.size(); ++t)
        (chosen[t] ? taken.triangles : kept).push_back(mesh.triangles[t]);
    mesh.triangles = std::move(kept);
    return taken;
}

} // namespace kokage
