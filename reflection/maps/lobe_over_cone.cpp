#include "reflection/maps/lobe_over_cone.h"

#include "common/directions/legendre.h"
#include "common/environment/light_harmonics.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

/// Half of the circle at `angle_from_lobe` around the lobe's axis that lies in the cone, in radians: the angle at the
/// axis of a spherical triangle with the sides `between`, `angle_from_lobe` and, opposite, `half_angle`.
/// sin²(B/2) = sin(s-a) sin(s-c) / (sin a sin c) keeps its digits for small triangles.
double half_arc_in_cone(double angle_from_lobe, double between, double half_angle) {
    if (angle_from_lobe + between <= half_angle || 2 * kPiDouble - angle_from_lobe - between <= half_angle)
        return kPiDouble;
    const double first = half_angle + angle_from_lobe - between, second = half_angle + between - angle_from_lobe;
    if (first <= 0 || second <= 0)
        return 0;
    const double sines = std::sin(angle_from_lobe) * std::sin(between);
    const double squared = sines > 0 ? std::sin(0.5 * first) * std::sin(0.5 * second) / sines : 1;
    return 2 * std::asin(std::sqrt(std::clamp(squared, 0.0, 1.0)));
}

/// Where the integrand bends: the cone's nearest and farthest point, and steps that grow with the distance from the
/// peak.
std::vector<double> borders_of(const Lobe& lobe, double between, double half_angle) {
    const double end = kPiDouble / 2;
    const double nearest = std::abs(between - half_angle);
    const double farthest = std::min(between + half_angle, 2 * kPiDouble - between - half_angle);
    std::vector<double> borders{0, nearest, farthest, end};
    const double width = std::sqrt(lobe_reach(lobe, 0.5));
    for (double angle = width; angle < end; angle *= 1.5)
        borders.push_back(angle);
    if (lobe.kind == LobeKind::phong && lobe.parameter < 10) // t^L has a root at the right angle
        for (double rest = 0.5; rest > 1e-12; rest *= 0.25)
            borders.push_back(end - rest);
    std::erase_if(borders, [&](double angle) { return !(angle >= 0 && angle <= end); });
    std::sort(borders.begin(), borders.end());
    return borders;
}

} // namespace

std::vector<LobeArc> arcs_in_cone(const Lobe& lobe, double angle, double half_angle, int nodes) {
    const std::vector<QuadratureNode> rule = gauss_legendre(nodes);
    const double reach = 2 * std::asin(std::sqrt(0.25 * lobe_reach(lobe, 1e-20)));
    const std::vector<double> borders = borders_of(lobe, angle, half_angle);
    std::vector<LobeArc> arcs;
    for (std::size_t piece = 1; piece < borders.size() && borders[piece - 1] < reach; ++piece) {
        const double half = 0.5 * (borders[piece] - borders[piece - 1]),
                     middle = 0.5 * (borders[piece] + borders[piece - 1]);
        if (half <= 0 || half_arc_in_cone(middle, angle, half_angle) == 0)
            continue;
        // The arc has the root of the distance from the cone's ends: theta = middle + half sin(psi) removes it.
        for (const QuadratureNode& node : rule) {
            const double psi = 0.5 * kPiDouble * node.x;
            const double theta = middle + half * std::sin(psi);
            const double step = 0.5 * kPiDouble * node.weight * half * std::cos(psi);
            const double chord = 2 * std::sin(0.5 * theta);
            arcs.push_back({theta, half_arc_in_cone(theta, angle, half_angle),
                            step * std::sin(theta) * lobe_value(lobe, chord * chord)});
        }
    }
    return arcs;
}

double lobe_over_cone(const Lobe& lobe, double angle, double half_angle) {
    double sum = 0;
    if (half_angle > 0)
        for (const LobeArc& arc : arcs_in_cone(lobe, angle, half_angle))
            sum += 2 * arc.half_arc * arc.mass;
    return sum;
}

namespace {

/// Integral of the lobe over a cone, per solid angle of the cone.
double mean_over_cone(const Lobe& lobe, const glm::dvec3& axis, const glm::dvec3& direction, double half_angle) {
    const glm::dvec3 between = axis - direction;
    const double squared_distance = glm::dot(between, between);
    if (!(half_angle > 0))
        return lobe_value(lobe, squared_distance);
    const double angle = 2 * std::asin(std::min(1.0, 0.5 * std::sqrt(squared_distance)));
    const double half_sine = std::sin(0.5 * half_angle);
    return lobe_over_cone(lobe, angle, half_angle) / (4 * kPiDouble * half_sine * half_sine);
}

} // namespace

glm::dvec3 light_through_lobe(const DistantLight& light, const Lobe& lobe, const glm::dvec3& direction) {
    if (light.texels.empty()) {
        return glm::dvec3(light.irradiance) * flux_per_irradiance(double(light.half_angle)) *
               mean_over_cone(lobe, glm::normalize(glm::dvec3(light.direction)), direction, double(light.half_angle));
    }
    glm::dvec3 sum(0.0);
    for (const DistantLight::Texel& texel : light.texels)
        sum += glm::dvec3(texel.irradiance) *
               mean_over_cone(lobe, glm::normalize(glm::dvec3(texel.direction)), direction, double(texel.half_angle));
    return sum;
}

} // namespace kokage
