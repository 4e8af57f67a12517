// How the exact mean over a texel comes about. With azimuth phi = atan2(z, x) and height h = y, solid angle is
// dphi dh. Let D(phi, h) be the integral of the image's column at phi from the pole down to h: piecewise linear in h.
// By Green's theorem the integral over a texel is the sum over its edges of ∫ D dphi, signed. Edges are arcs of great
// circles: on one whose highest point has slope t (the tangent of its elevation) and lies at psi = 0,
//
//     tan(elevation) = t cos psi,    ∫ h dpsi = asin(t sin psi / sqrt(1 + t²)),
//
// so between crossings of pixel borders ∫ D dpsi is in closed form. Edges along meridians have dphi = 0 and drop out:
// the side faces (X, Z) have only their horizontal edges; on the Y faces, lines s = const and t = const at distance b
// from the middle are the same curves with slope 1/b, turned by quarter turns. So one walk along a curve serves the
// four quarter turns and both hemispheres: eight copies.
#include "reflection/maps/cube_area_filter.h"
#include "common/services/parallel.h"
#include "reflection/maps/prefiltered_cube.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kokage {
namespace {

/// D of the image's columns: in row k it is offset(k) - L h, L the pixel, h the height.
struct Columns {
    const Image* image = nullptr;
    int width = 0, height = 0;
    std::vector<double> row_height; ///< h of the border above row k, and of the lowest
    std::vector<double> row_slope;  ///< tangent of that border's elevation
    std::vector<glm::dvec3> offset; ///< row by row
    std::vector<glm::dvec3> total;  ///< of a whole column, pole to pole

    glm::dvec3 radiance(int row, int column) const {
        const float* pixel = image->at(column, row);
        return {double(pixel[0]), double(pixel[1]), double(pixel[2])};
    }
};

Columns columns_of(const Image& image) {
    Columns c{&image, image.width, image.height, {}, {}, {}, {}};
    for (int k = 0; k <= c.height; ++k) {
        const double elevation = kPiDouble / 2 - kPiDouble * k / c.height;
        c.row_height.push_back(2 * k == c.height ? 0. : std::sin(elevation));
        c.row_slope.push_back(2 * k == c.height ? 0. : std::tan(elevation));
    }
    c.row_slope.front() = HUGE_VAL;
    c.row_slope.back() = -HUGE_VAL;
    c.total.assign(std::size_t(c.width), glm::dvec3(0.));
    c.offset.resize(std::size_t(c.width) * std::size_t(c.height));
    for (int k = 0; k < c.height; ++k) {
        const double top = c.row_height[std::size_t(k)], bottom = c.row_height[std::size_t(k) + 1];
        for (int x = 0; x < c.width; ++x) {
            glm::dvec3& sum = c.total[std::size_t(x)];
            const glm::dvec3 l = c.radiance(k, x);
            c.offset[std::size_t(k) * std::size_t(c.width) + std::size_t(x)] = sum + l * top;
            sum += l * (top - bottom);
        }
    }
    return c;
}

/// Quarter turn i looks along phi = quarter_turn[i] at psi = 0, and phi falls as psi grows: +X, +Z, -X, -Z.
constexpr std::array<double, 4> kQuarterTurns = {0, 0.5, 1, -0.5}; ///< of pi

/// ∫ D dpsi along curves: `lines` of them with `edges` pieces each, for every quarter turn, in the upper hemisphere and
/// mirrored in the lower one.
struct Family {
    int lines = 0, edges = 0;
    bool lower_from_pole = false; ///< D of the lower copies counts from the lower pole
    std::array<std::vector<glm::dvec3>, 4> upper, lower;

    const glm::dvec3& upper_at(int turn, int line, int edge) const { return at(upper, turn, line, edge); }
    const glm::dvec3& lower_at(int turn, int line, int edge) const { return at(lower, turn, line, edge); }

    Family(int line_count, int edge_count, bool from_pole)
        : lines(line_count), edges(edge_count), lower_from_pole(from_pole) {
        for (int turn = 0; turn < 4; ++turn)
            for (auto* integrals : {&upper[std::size_t(turn)], &lower[std::size_t(turn)]})
                integrals->assign(std::size_t(lines) * std::size_t(edges), glm::dvec3(0.));
    }

  private:
    const glm::dvec3& at(const std::array<std::vector<glm::dvec3>, 4>& integrals, int turn, int line, int edge) const {
        return integrals[std::size_t(turn)][std::size_t(line) * std::size_t(edges) + std::size_t(edge)];
    }
};

/// Walks along a curve of slope `slope` > 0 from one end to the other, its pieces bounded by tan psi = scale (2 i /
/// edges - 1), and adds to the integrals of line `line`.
class CurveWalk {
  public:
    CurveWalk(const Columns& columns, Family& family, int line, double slope, double scale)
        : columns_(columns), family_(family), line_(line), slope_(slope), sine_factor_(slope / std::hypot(1., slope)),
          scale_(scale), column_width_(2 * kPiDouble / columns.width) {}

    void run() {
        // Where psi = 0 lies among the columns, and how far into one. All four quarter turns share their crossings if
        // the columns repeat with them.
        if (columns_.width % 4 == 0) {
            walk(0, 4);
        } else {
            for (int turn = 0; turn < 4; ++turn)
                walk(turn, turn + 1);
        }
    }

  private:
    void walk(int first_turn, int end_turn) {
        const double place = (kQuarterTurns[std::size_t(first_turn)] + 1) / 2 * columns_.width;
        const double fraction = place - std::floor(place);
        const double end = std::atan(scale_);
        double psi = -end, integral_of_height = height_integral(-end);
        // Columns between psi = (fraction + m) width and (fraction + m + 1) width.
        int m = int(std::floor(-end / column_width_ - fraction));
        set_columns(first_turn, end_turn, m);
        int row = row_of(slope_ * std::cos(psi));
        bool falling = false; // the curve climbs until psi = 0
        double crossing = row_crossing(row, falling);
        for (int edge = 0; edge < family_.edges; ++edge) {
            const double edge_end =
                edge + 1 == family_.edges ? end : std::atan(scale_ * (2. * (edge + 1) / family_.edges - 1));
            while (psi < edge_end) {
                double next = edge_end;
                enum { at_edge, at_column, at_row, at_summit } stop = at_edge;
                if (const double border = (fraction + m + 1) * column_width_; border < next) {
                    next = border;
                    stop = at_column;
                }
                if (!falling && next > 0) {
                    next = 0;
                    stop = at_summit;
                }
                if (crossing < next) {
                    next = std::max(crossing, psi);
                    stop = at_row;
                }
                const double integral = height_integral(next);
                add(first_turn, end_turn, edge, row, next - psi, integral - integral_of_height);
                psi = next;
                integral_of_height = integral;
                if (stop == at_edge)
                    break;
                if (stop == at_column) {
                    ++m;
                    next_columns(first_turn, end_turn);
                    continue;
                }
                if (stop == at_row)
                    row += falling ? 1 : -1;
                else
                    falling = true;
                crossing = row_crossing(row, falling);
            }
        }
    }

    double height_integral(double psi) const { return std::asin(sine_factor_ * std::sin(psi)); }

    int row_of(double slope) const {
        const auto& borders = columns_.row_slope; // falling
        const auto below = std::lower_bound(borders.begin() + 1, borders.end(), slope, std::greater<>());
        return std::clamp(int(below - borders.begin()) - 1, 0, columns_.height - 1);
    }

    /// Where the curve leaves the row through its upper border (climbing) or lower border (falling).
    double row_crossing(int row, bool falling) const {
        const double cosine = columns_.row_slope[std::size_t(falling ? row + 1 : row)] / slope_;
        if (!(cosine > 0 && cosine < 1)) // above the summit, or below the horizon, which is met a quarter turn away
            return HUGE_VAL;
        return falling ? std::acos(cosine) : -std::acos(cosine);
    }

    void set_columns(int first_turn, int end_turn, int m) {
        for (int turn = first_turn; turn < end_turn; ++turn) {
            const double place = (kQuarterTurns[std::size_t(turn)] + 1) / 2 * columns_.width;
            const int column = (int(std::floor(place)) - m - 1) % columns_.width;
            column_[std::size_t(turn)] = column < 0 ? column + columns_.width : column;
        }
    }

    void next_columns(int first_turn, int end_turn) {
        for (int turn = first_turn; turn < end_turn; ++turn) {
            int& column = column_[std::size_t(turn)];
            column = column == 0 ? columns_.width - 1 : column - 1;
        }
    }

    void add(int first_turn, int end_turn, int edge, int row, double width, double height_width) {
        const std::size_t at = std::size_t(line_) * std::size_t(family_.edges) + std::size_t(edge);
        const int mirrored = columns_.height - 1 - row;
        for (int turn = first_turn; turn < end_turn; ++turn) {
            const int column = column_[std::size_t(turn)];
            auto offset = [&](int k) {
                return columns_.offset[std::size_t(k) * std::size_t(columns_.width) + std::size_t(column)];
            };
            family_.upper[std::size_t(turn)][at] += offset(row) * width - columns_.radiance(row, column) * height_width;
            const glm::dvec3 below = offset(mirrored) * width + columns_.radiance(mirrored, column) * height_width;
            family_.lower[std::size_t(turn)][at] +=
                family_.lower_from_pole ? columns_.total[std::size_t(column)] * width - below : below;
        }
    }

    const Columns& columns_;
    Family& family_;
    int line_;
    double slope_, sine_factor_, scale_, column_width_;
    std::array<int, 4> column_{};
};

/// The texels in the making.
struct Cube {
    int size;
    std::vector<double> solid_angles; ///< of a face
    std::vector<glm::vec3> texels;

    /// Integral -> mean. Rounding may leave a black texel a little below 0.
    void put(int face, int x, int y, const glm::dvec3& integral) {
        const std::size_t in_face = std::size_t(y) * std::size_t(size) + std::size_t(x);
        texels[std::size_t(face) * solid_angles.size() + in_face] =
            glm::vec3(glm::max(integral / solid_angles[in_face], 0.));
    }
};

/// The X and Z faces: horizontal edges alone. Line j has t = 1 - 2j / size >= 0.
void fill_sides(Cube& cube, const Columns& columns) {
    const int size = cube.size;
    Family family(size / 2 + 1, size, false);
    parallel_blocks(std::size_t(family.lines), 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t j = begin; j < end; ++j)
            CurveWalk(columns, family, int(j), 1 - 2. * double(j) / size, 1).run();
    });
    constexpr std::array<int, 4> face_of_turn = {0, 4, 1, 5};
    parallel_blocks(std::size_t(size), 16, [&](std::size_t begin, std::size_t end) {
        for (int turn = 0; turn < 4; ++turn) {
            auto border = [&](int j, int x) {
                return 2 * j <= size ? family.upper_at(turn, j, x) : family.lower_at(turn, size - j, x);
            };
            for (int y = int(begin); y < int(end); ++y)
                for (int x = 0; x < size; ++x)
                    cube.put(face_of_turn[std::size_t(turn)], x, y, border(y + 1, x) - border(y, x));
        }
    });
}

/// The Y faces. Grid line g lies at 2g / size - 1 from the middle; the lines at +-b share a curve.
void fill_caps(Cube& cube, const Columns& columns) {
    const int size = cube.size;
    Family family((size + 1) / 2, size, true);
    auto line_of = [&](int g) { return (std::abs(2 * g - size) + 1) / 2 - 1; };
    parallel_blocks(std::size_t(family.lines), 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const double b = (size % 2 == 0 ? 2. * double(i + 1) : 2. * double(i) + 1) / size;
            CurveWalk(columns, family, int(i), 1 / b, 1 / b).run();
        }
    });
    // What lies between the pole and an edge of the line t = grid line g (or s = ...), positive on the far side.
    auto sector = [&](bool lower, int positive_turn, int negative_turn, int g, int positive_edge, int negative_edge) {
        if (2 * g == size) // through the pole, along meridians
            return glm::dvec3(0.);
        auto at = [&](int turn, int edge) {
            return lower ? family.lower_at(turn, line_of(g), edge) : family.upper_at(turn, line_of(g), edge);
        };
        return 2 * g > size ? at(positive_turn, positive_edge) : -at(negative_turn, negative_edge);
    };
    parallel_blocks(std::size_t(size), 16, [&](std::size_t begin, std::size_t end) {
        for (const bool lower : {false, true})
            for (int row = int(begin); row < int(end); ++row)
                for (int x = 0; x < size; ++x) {
                    const int mirrored_x = size - 1 - x, mirrored_row = size - 1 - row;
                    auto across_t = [&](int g) { return sector(lower, 1, 3, g, x, mirrored_x); };
                    auto across_s = [&](int g) { return sector(lower, 0, 2, g, mirrored_row, row); };
                    // The lower face counts t the other way.
                    cube.put(lower ? 3 : 2, x, lower ? mirrored_row : row,
                             across_t(row + 1) - across_t(row) + across_s(x + 1) - across_s(x));
                }
    });
}

} // namespace

std::vector<glm::vec3> cube_from_lat_long(const Image& image, int size) {
    const Columns columns = columns_of(image);
    Cube cube{size, cube_texel_solid_angles(size), std::vector<glm::vec3>(6 * std::size_t(size) * std::size_t(size))};
    fill_sides(cube, columns);
    fill_caps(cube, columns);
    return std::move(cube.texels);
}

namespace {

double solid_angle_of(std::size_t texel, int size) {
    const int in_face = int(texel % (std::size_t(size) * std::size_t(size)));
    return cube_texel_solid_angle(in_face % size, in_face / size, size);
}

/// A cone of few texels: points of equal area on a spiral, turned by the golden angle from one to the next.
void add_points(std::vector<glm::vec3>& texels, int size, const glm::dvec3& z, double half_angle,
                const glm::dvec3& light) {
    const int points = half_angle > 0 ? 4096 : 1;
    const glm::dvec3 x = glm::normalize(glm::cross(z, std::abs(z.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0)));
    const glm::dvec3 y = glm::cross(z, x);
    const double depth = 2 * std::pow(std::sin(half_angle / 2), 2); // 1 - cos
    for (int i = 0; i < points; ++i) {
        const double drop = points == 1 ? 0 : depth * (i + 0.5) / points, radius = std::sqrt(drop * (2 - drop));
        const double turn = i * kPiDouble * (3 - std::sqrt(5.));
        const std::size_t at =
            cube_texel_towards((1 - drop) * z + radius * (std::cos(turn) * x + std::sin(turn) * y), size);
        texels[at] += glm::vec3(light / double(points) / solid_angle_of(at, size));
    }
}

/// A wider cone: of each texel, how much lies in the cone, by 16 x 16 points where its border passes.
void add_covered(std::vector<glm::vec3>& texels, int size, const glm::dvec3& axis, double half_angle,
                 const glm::dvec3& light) {
    constexpr int grain = 16;
    const double reach = 2. / size; // no texel extends farther from its centre: half of sqrt(2) 2 / size
    const double surely = std::cos(std::max(half_angle - reach, 0.)), perhaps = std::cos(half_angle + reach);
    const double border = std::cos(half_angle);
    std::vector<std::pair<std::size_t, double>> covered;
    double solid_angle = 0;
    for (int face = 0; face < 6; ++face)
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                const double cosine = glm::dot(cube_texel_direction(face, x, y, size), axis);
                if (cosine < perhaps)
                    continue;
                const bool whole = cosine > surely && half_angle > reach;
                int inside = whole ? grain * grain : 0;
                for (int i = 0; !whole && i < grain * grain; ++i)
                    inside +=
                        glm::dot(cube_texel_direction(face, x * grain + i % grain, y * grain + i / grain, size * grain),
                                 axis) > border;
                const double share = double(inside) / (grain * grain);
                covered.emplace_back(cube_texel_index(face, x, y, size), share);
                solid_angle += share * cube_texel_solid_angle(x, y, size);
            }
    for (const auto& [at, share] : covered)
        texels[at] += glm::vec3(light * (share / solid_angle));
}

/// `light` = radiance x solid angle, spread evenly over a cone.
void add_cone(std::vector<glm::vec3>& texels, int size, const glm::vec3& axis, float half_angle,
              const glm::dvec3& light) {
    const bool wide = double(half_angle) > 4. / size; // two texels
    (wide ? add_covered : add_points)(texels, size, glm::normalize(glm::dvec3(axis)), double(half_angle), light);
}

} // namespace

void add_lights_to_cube(std::vector<glm::vec3>& texels, int size, const std::vector<DistantLight>& lights) {
    // A disc of radiance L gives a surface that faces it L pi sin², and has 2 pi (1 - cos) of solid angle.
    auto facing_over_all = [](double half_angle) { return std::pow(std::cos(half_angle / 2), 2); };
    for (const DistantLight& light : lights) {
        if (light.texels.empty())
            add_cone(texels, size, light.direction, light.half_angle,
                     glm::dvec3(light.irradiance) / facing_over_all(double(light.half_angle)));
        for (const DistantLight::Texel& texel : light.texels) // their irradiance is radiance x solid angle
            add_cone(texels, size, texel.direction, texel.half_angle, glm::dvec3(texel.irradiance));
    }
}

} // namespace kokage
