#include "reflection/maps/prefiltered_cube.h"
#include "common/services/error.h"
#include "common/services/stopwatch.h"
#include "reflection/maps/cube_area_filter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace kokage {
namespace {

constexpr int kLargestSize = 16384, kLeastLevels = 5;

/// The point of the cube's surface, or of a face's plane beyond it, at (s, t) of a face.
glm::dvec3 face_point(int face, double s, double t) {
    switch (face) {
    case 0:
        return {1, -t, -s};
    case 1:
        return {-1, -t, s};
    case 2:
        return {s, 1, t};
    case 3:
        return {s, -1, -t};
    case 4:
        return {s, -t, 1};
    default:
        return {-s, -t, -1};
    }
}

struct CubePlace {
    int face;
    double s, t; ///< -1 ... 1
};

CubePlace face_of(const glm::dvec3& d) {
    const glm::dvec3 a = glm::abs(d);
    if (a.x >= a.y && a.x >= a.z)
        return d.x >= 0 ? CubePlace{0, -d.z / a.x, -d.y / a.x} : CubePlace{1, d.z / a.x, -d.y / a.x};
    if (a.y >= a.z)
        return d.y >= 0 ? CubePlace{2, d.x / a.y, d.z / a.y} : CubePlace{3, d.x / a.y, -d.z / a.y};
    return d.z >= 0 ? CubePlace{4, d.x / a.z, -d.y / a.z} : CubePlace{5, -d.x / a.z, -d.y / a.z};
}

int texel_of(double s, int size) {
    return std::clamp(int(std::floor((s + 1) / 2 * size)), 0, size - 1);
}

double position_of(int x, int size) {
    return (2 * x + 1) / double(size) - 1;
}

/// Solid angle of a face's rectangle from its middle to (s, t), signed: atan(s t / sqrt(1 + s² + t²)).
double rectangle_solid_angle(double s, double t) {
    return std::atan2(s * t, std::sqrt(1 + s * s + t * t));
}

} // namespace

bool is_unfiltered(LobeKind kind, double parameter) {
    return kind == LobeKind::ggx ? parameter == 0 : std::isinf(parameter) && parameter > 0;
}

void check_cube(const CubeSettings& settings) {
    auto fail = [](const std::string& why) { throw InputError("cube map: " + why); };
    const std::size_t levels = settings.parameters.size();
    if (settings.size < 1 || settings.size > kLargestSize)
        fail("its faces are " + std::to_string(settings.size) + " texels wide; take 1 to " +
             std::to_string(kLargestSize));
    if (levels == 0)
        fail("no level is asked for; give one roughness a level");
    if (levels > 1 && (settings.size & (settings.size - 1)) != 0)
        fail("faces of " + std::to_string(settings.size) +
             " texels can't be halved evenly from level to level; take a power of two");
    if (levels > 30 || (settings.size >> (levels - 1)) < 1)
        fail(std::to_string(levels) + " levels are more than faces of " + std::to_string(settings.size) +
             " texels have; ask for fewer, or for larger faces");
    for (std::size_t i = 0; i < levels; ++i) {
        const double p = settings.parameters[i];
        const std::string which = "level " + std::to_string(i) + " of it has ";
        if (is_unfiltered(settings.kind, p)) {
            if (i > 0)
                fail(which + "no lobe; only level 0 can be the image itself");
        } else if (settings.kind == LobeKind::ggx ? !(p > 0 && p <= 1) : !(p >= 0 && p < 1e9)) {
            fail(which + (settings.kind == LobeKind::ggx ? "roughness " : "exponent ") + std::to_string(p) +
                 (settings.kind == LobeKind::ggx ? "; it goes from 0 to 1" : "; it goes from 0 to 1e9"));
        }
    }
}

glm::dvec3 cube_texel_direction(int face, int x, int y, int size) {
    return glm::normalize(face_point(face, position_of(x, size), position_of(y, size)));
}

double cube_texel_solid_angle(int x, int y, int size) {
    const double s0 = 2. * x / size - 1, s1 = 2. * (x + 1) / size - 1;
    const double t0 = 2. * y / size - 1, t1 = 2. * (y + 1) / size - 1;
    return rectangle_solid_angle(s1, t1) - rectangle_solid_angle(s0, t1) - rectangle_solid_angle(s1, t0) +
           rectangle_solid_angle(s0, t0);
}

std::vector<double> cube_texel_solid_angles(int size) {
    // A quarter of the face, its corner at the middle; the others mirror it.
    const int count = (size + 1) / 2, middle = size - count;
    auto line = [&](int i) { return 2. * (middle + i) / size - 1; };
    const std::size_t n = std::size_t(size);
    std::vector<double> above(std::size_t(count) + 1), below(std::size_t(count) + 1), angles(n * n);
    for (int i = 0; i <= count; ++i)
        above[std::size_t(i)] = rectangle_solid_angle(line(i), line(0));
    for (int y = 0; y < count; ++y) {
        for (int i = 0; i <= count; ++i)
            below[std::size_t(i)] = rectangle_solid_angle(line(i), line(y + 1));
        for (int x = 0; x < count; ++x) {
            const std::size_t i = std::size_t(x);
            const double angle = below[i + 1] - below[i] - above[i + 1] + above[i];
            for (const int row : {middle + y, count - 1 - y})
                for (const int column : {middle + x, count - 1 - x})
                    angles[std::size_t(row) * n + std::size_t(column)] = angle;
        }
        std::swap(above, below);
    }
    return angles;
}

int usual_level_count(int size) {
    int levels = 1;
    while (size % 2 == 0 && (size / 2 >= 16 || levels < kLeastLevels)) {
        size /= 2;
        ++levels;
    }
    return levels;
}

std::vector<double> even_roughness(int levels) {
    std::vector<double> roughness(std::size_t(std::max(levels, 1)));
    for (std::size_t i = 1; i < roughness.size(); ++i)
        roughness[i] = double(i) / double(roughness.size() - 1);
    return roughness;
}

std::vector<double> filament_roughness(int levels) {
    std::vector<double> roughness = even_roughness(levels);
    for (double& r : roughness)
        r = 1 - std::sqrt(1 - r);
    return roughness;
}

PrefilteredCube empty_cube(const CubeSettings& settings) {
    check_cube(settings);
    PrefilteredCube cube;
    cube.kind = settings.kind;
    for (std::size_t i = 0; i < settings.parameters.size(); ++i) {
        PrefilteredCube::Level level;
        level.size = settings.size >> i;
        level.parameter = settings.parameters[i];
        level.unfiltered = is_unfiltered(settings.kind, level.parameter);
        level.texels.resize(6 * std::size_t(level.size) * std::size_t(level.size));
        cube.levels.push_back(std::move(level));
    }
    return cube;
}

TexelLayout filtered_layout(const PrefilteredCube& cube) {
    TexelLayout layout;
    layout.kind = cube.kind;
    for (const PrefilteredCube::Level& level : cube.levels) {
        if (level.unfiltered)
            continue;
        for (int face = 0; face < 6; ++face)
            for (int y = 0; y < level.size; ++y)
                for (int x = 0; x < level.size; ++x)
                    layout.directions.emplace_back(cube_texel_direction(face, x, y, level.size));
        layout.parameters.resize(layout.directions.size(), float(level.parameter));
    }
    return layout;
}

void set_filtered_texels(PrefilteredCube& cube, std::span<const glm::vec3> filtered) {
    std::size_t at = 0;
    for (PrefilteredCube::Level& level : cube.levels)
        if (!level.unfiltered) {
            std::copy_n(filtered.begin() + std::ptrdiff_t(at), level.texels.size(), level.texels.begin());
            at += level.texels.size();
        }
}

void bake_cube(PrefilteredCube& cube, const Environment& surroundings, Baker* baker, WorkReport& report,
               Progress& progress) {
    for (PrefilteredCube::Level& level : cube.levels)
        if (level.unfiltered) {
            const Stopwatch watch;
            progress.throw_if_stopped();
            level.texels = cube_from_lat_long(surroundings.remainder, level.size);
            add_lights_to_cube(level.texels, level.size, surroundings.distant_lights);
            report.stages.push_back({"averaging the image over the cube", watch.cpu(), watch.wall()});
        }
    std::size_t count = 0;
    for (const PrefilteredCube::Level& level : cube.levels)
        count += level.unfiltered ? 0 : level.texels.size();
    if (count == 0)
        return;
    std::vector<glm::vec3> filtered(count);
    baker->bake(surroundings, filtered, report, progress);
    set_filtered_texels(cube, filtered);
}

std::size_t cube_texel_towards(const glm::dvec3& direction, int size) {
    const CubePlace place = face_of(direction);
    return cube_texel_index(place.face, texel_of(place.s, size), texel_of(place.t, size), size);
}

std::size_t cube_texel_index(int face, int x, int y, int size) {
    if (x < 0 || x >= size || y < 0 || y >= size) {
        // Fold the plane of the face over its edge: what lies a half texel beyond it lies as far behind it.
        const double s = position_of(x, size), t = position_of(y, size);
        const double beyond = std::max(std::abs(s), std::abs(t)) - 1;
        const glm::dvec3 middle = face_point(face, 0, 0);
        const glm::dvec3 point =
            (1 - beyond) * middle + face_point(face, std::clamp(s, -1., 1.), std::clamp(t, -1., 1.)) - middle;
        const CubePlace place = face_of(point);
        face = place.face;
        x = texel_of(place.s, size);
        y = texel_of(place.t, size);
    }
    return (std::size_t(face) * std::size_t(size) + std::size_t(y)) * std::size_t(size) + std::size_t(x);
}

glm::vec3 cube_lookup(const PrefilteredCube::Level& level, const glm::dvec3& direction) {
    const CubePlace place = face_of(direction);
    const double x = (place.s + 1) / 2 * level.size - 0.5, y = (place.t + 1) / 2 * level.size - 0.5;
    const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
    const double fx = x - x0, fy = y - y0;
    std::array<glm::dvec3, 4> texels;
    int beyond_corner = -1;
    glm::dvec3 sum(0.);
    for (int i = 0; i < 4; ++i) {
        const int tx = x0 + i % 2, ty = y0 + i / 2;
        if ((tx < 0 || tx >= level.size) && (ty < 0 || ty >= level.size)) {
            beyond_corner = i;
            continue;
        }
        texels[std::size_t(i)] = glm::dvec3(level.texels[cube_texel_index(place.face, tx, ty, level.size)]);
        sum += texels[std::size_t(i)];
    }
    if (beyond_corner >= 0)
        texels[std::size_t(beyond_corner)] = sum / 3.;
    return glm::vec3(glm::mix(glm::mix(texels[0], texels[1], fx), glm::mix(texels[2], texels[3], fx), fy));
}

glm::vec3 cube_lookup(const PrefilteredCube& cube, const glm::dvec3& direction, double lod) {
    const double l = std::clamp(lod, 0., double(cube.levels.size() - 1));
    const std::size_t low = std::size_t(l), high = std::min(low + 1, cube.levels.size() - 1);
    const glm::vec3 a = cube_lookup(cube.levels[low], direction);
    return high == low ? a : glm::mix(a, cube_lookup(cube.levels[high], direction), float(l - double(low)));
}

} // namespace kokage
