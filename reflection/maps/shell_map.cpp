#include "reflection/maps/shell_map.h"

#include "common/services/error.h"
#include "common/services/parallel.h"
#include "reflection/maps/face_chart.h"
#include "reflection/maps/shell_lookup.h"
#include "reflection/maps/texel_prefilter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

namespace kokage {
namespace {

constexpr int kLeastResolution = 16, kMostResolution = 8192, kMostShells = int(ShellTable::most_shells);

void check(const ShellSettings& s) {
    const auto number = [](double value) {
        std::array<char, 32> text{};
        std::snprintf(text.data(), text.size(), "%g", value);
        return std::string(text.data());
    };
    const bool phong = s.kind == LobeKind::phong;
    const double least = phong ? 0 : 0.01, most = phong ? 1e6 : 1;
    if (!(s.least_parameter >= least && s.least_parameter <= s.most_parameter && s.most_parameter <= most))
        throw InputError("shell map from " + number(s.least_parameter) + " to " + number(s.most_parameter) +
                         ": ask for " + (phong ? "exponents between 0 and 1000000" : "roughnesses between 0.01 and 1") +
                         ", the smaller one first");
    if (!(s.shell_ratio > 1 && s.shell_ratio <= 4))
        throw InputError("shell map with shells " + number(s.shell_ratio) +
                         " widths apart: ask for 1 to 4, 1 excluded");
    if (!(s.texels_a_width >= 0.25 && s.texels_a_width <= 16))
        throw InputError("shell map of " + number(s.texels_a_width) + " texels a lobe's width: ask for 0.25 to 16");
}

double spacing_power_of(double width) {
    return std::pow(width, double(ShellMap::spacing_power));
}

int resolution_of(double width, double texels_a_width) {
    const double wanted = 1 + kPiDouble / 2 * texels_a_width / width;
    return std::clamp(int(std::ceil(wanted - 1e-6)), kLeastResolution, kMostResolution);
}

std::size_t face_texels(int resolution, int border) {
    const auto edge = std::size_t(resolution + 2 * border);
    return edge * edge;
}

/// Texels of a whole shell, border included, plainly on their grid.
void add_directions(std::vector<glm::vec3>& directions, int resolution, int border) {
    const double step = 2.0 / (resolution - 1);
    for (int face = 0; face < 6; ++face)
        for (int y = -border; y < resolution + border; ++y)
            for (int x = -border; x < resolution + border; ++x)
                directions.push_back(face_direction(face, x * step - 1, y * step - 1));
}

} // namespace

std::vector<ShellMap::Shell> ShellMap::plan(const ShellSettings& settings) {
    check(settings);
    const double ends[2] = {lobe_width({settings.kind, settings.least_parameter}),
                            lobe_width({settings.kind, settings.most_parameter})};
    const double rough = std::max(ends[0], ends[1]), smooth = std::min(ends[0], ends[1]);
    const double range = spacing_power_of(rough) - spacing_power_of(smooth),
                 widest = spacing_power_of(smooth * settings.shell_ratio) - spacing_power_of(smooth);
    const double wanted = std::ceil(range / widest - 1e-9);
    if (!(wanted < kMostShells))
        throw InputError("shell map with shells " + std::to_string(settings.shell_ratio) + " widths apart: more than " +
                         std::to_string(kMostShells) + " shells; ask for a larger ratio");
    const int intervals = int(wanted);
    std::vector<Shell> shells;
    std::size_t stored = 0, baked = 0;
    for (int i = 0; i <= intervals; ++i) {
        const double between = spacing_power_of(rough) - range * i / std::max(intervals, 1);
        const double width = i == 0 ? rough : i == intervals ? smooth : std::pow(between, 1 / double(spacing_power));
        Shell shell;
        shell.lobe = lobe_of_width(settings.kind, width);
        shell.width = float(width);
        shell.resolution = resolution_of(width, settings.texels_a_width);
        shell.first = stored;
        shell.first_baked = baked;
        stored += 6 * face_texels(shell.resolution, border(settings.filter));
        baked += 6 * face_texels(shell.resolution, baked_border(settings.filter));
        shells.push_back(shell);
    }
    if (stored * texel_bytes(settings.format) > (std::size_t(1) << 31) - 4)
        throw InputError("shell map of more than 2 GB: ask for fewer texels a lobe's width, or rougher lobes");
    return shells;
}

ShellMap::ShellMap(const ShellSettings& settings) : settings_(settings), shells_(plan(settings)) {
    first_power_ = float(spacing_power_of(shells_.front().width));
    if (shells_.size() > 1)
        shells_a_power_ = float(shells_.size() - 1) / (first_power_ - float(spacing_power_of(shells_.back().width)));
    layout_.kind = settings.kind;
    for (const Shell& shell : shells_) {
        add_directions(layout_.directions, shell.resolution, baked_border());
        layout_.parameters.resize(layout_.size(), float(shell.lobe.parameter));
    }
    texel_count_ = shells_.back().first + 6 * face_texels(shells_.back().resolution, border());
    texels_.resize(bytes() + 4);
}

void ShellMap::set_texels(std::span<const glm::vec3> filtered) {
    if (filtered.size() != layout_.size())
        throw InputError("shell map: " + std::to_string(filtered.size()) + " texels given, its layout has " +
                         std::to_string(layout_.size()));
    const bool cubic = settings_.filter == TexelFilter::cubic;
    const SymmetricTaps taps = cubic ? cubic_prefilter() : bilinear_prefilter();
    const std::size_t each = texel_bytes(settings_.format);
    parallel_blocks(6 * shells_.size(), 1, [&](std::size_t begin, std::size_t) {
        const Shell& shell = shells_[shells_.size() - 1 - begin / 6]; // the large ones first
        const std::size_t baked = face_texels(shell.resolution, baked_border());
        const std::size_t stored = face_texels(shell.resolution, border()), face = begin % 6;
        std::vector<glm::vec3> texels = prefiltered(filtered.subspan(shell.first_baked + face * baked, baked),
                                                    shell.resolution + 2 * baked_border(), taps, 0);
        if (!cubic) // what is sharpened may undershoot; a spline's coefficients may be negative, lookups are not
            for (glm::vec3& texel : texels)
                texel = glm::max(texel, glm::vec3(0));
        const auto packed = packed_texels(texels, settings_.format);
        std::copy(packed.begin(), packed.end(), texels_.begin() + std::ptrdiff_t((shell.first + face * stored) * each));
    });
}

void ShellMap::restore_texels(std::span<const std::byte> stored) {
    if (stored.size() != bytes())
        throw InputError("shell map: " + std::to_string(stored.size()) + " bytes of texels given, it has " +
                         std::to_string(bytes()));
    std::copy(stored.begin(), stored.end(), texels_.begin());
}

ShellMap::Between ShellMap::between(float width) const {
    if (shells_.size() == 1)
        return {0, 0};
    const float clamped = std::clamp(width, shells_.back().width, shells_.front().width);
    const float position = (first_power_ - std::pow(clamped, spacing_power)) * shells_a_power_;
    const int index = std::clamp(int(position), 0, int(shells_.size()) - 2);
    const float a = shells_[std::size_t(index)].width, b = shells_[std::size_t(index) + 1].width;
    return {index, std::clamp((a - clamped) / (a - b), 0.f, 1.f)};
}

namespace {

/// Weights of the texels around a place that is `f` behind the texel of its cell.
struct Weights {
    int count;
    float weight[4];
};
Weights weights(TexelFilter filter, float f) {
    if (filter == TexelFilter::bilinear)
        return {2, {1 - f, f}};
    const float g = 1 - f; // uniform cubic B-spline
    return {4, {g * g * g / 6, (4 + f * f * (3 * f - 6)) / 6, (4 + g * g * (3 * g - 6)) / 6, f * f * f / 6}};
}

} // namespace

glm::vec3 ShellMap::shell_lookup(const Shell& shell, int face, float u, float v) const {
    const float half = 0.5f * float(shell.resolution - 1), x = half * u + half, y = half * v + half;
    const int last_cell = shell.resolution - 2;
    const int column = std::clamp(int(x), 0, last_cell), row = std::clamp(int(y), 0, last_cell);
    const Weights along_u = weights(settings_.filter, x - float(column));
    const Weights along_v = weights(settings_.filter, y - float(row));
    // The first weight belongs to the cell's texel (bilinear) or to the one before it, which the border shifts to.
    const std::size_t edge = std::size_t(shell.resolution + 2 * border());
    const std::size_t first = shell.first + (std::size_t(face) * edge + std::size_t(row)) * edge + std::size_t(column);
    glm::vec3 sum(0);
    for (int j = 0; j < along_v.count; ++j)
        for (int i = 0; i < along_u.count; ++i) {
            const std::size_t texel = first + std::size_t(j) * edge + std::size_t(i);
            sum += along_v.weight[j] * along_u.weight[i] *
                   unpacked_texel(texels_.data() + texel * texel_bytes(settings_.format), settings_.format);
        }
    return sum;
}

glm::vec3 ShellMap::lookup(const glm::vec3& direction, double parameter) const {
    const FacePlace place = face_place(direction);
    const Between place_between = between(float(lobe_width({settings_.kind, parameter})));
    const std::size_t i = std::size_t(place_between.index);
    glm::vec3 sum = (1 - place_between.share) * shell_lookup(shells_[i], place.face, place.u, place.v);
    if (place_between.share > 0)
        sum += place_between.share * shell_lookup(shells_[i + 1], place.face, place.u, place.v);
    return glm::max(sum, glm::vec3(0));
}

ShellTable ShellMap::table() const {
    ShellTable table;
    table.kind = settings_.kind;
    table.filter = settings_.filter;
    table.format = settings_.format;
    table.texels = texels_.data();
    table.least_width = shells_.back().width;
    table.most_width = shells_.front().width;
    table.first_power = first_power_;
    table.shells_a_power = shells_a_power_;
    table.last_shell = std::int32_t(shells_.size()) - 1;
    table.last_interval = std::max(table.last_shell - 1, 0);
    for (std::size_t i = 0; i < shells_.size(); ++i) {
        table.width[i] = shells_[i].width;
        table.resolution[i] = shells_[i].resolution;
        table.first[i] = std::int32_t(shells_[i].first);
    }
    return table;
}

void ShellMap::lookup(std::span<const glm::vec3> directions, std::span<const float> parameters,
                      std::span<glm::vec3> filtered) const {
    const ShellTable shells = table();
    const std::size_t lanes = shell_lookup_lanes();
    parallel_blocks(directions.size(), 4096, [&](std::size_t begin, std::size_t end) {
        const std::size_t whole = begin + (end - begin) / lanes * lanes;
        if (whole > begin)
            look_up_shells(shells, &directions[begin].x, &parameters[begin], &filtered[begin].x, whole - begin);
        if (whole == end)
            return;
        // The last ones, which do not fill a vector: with copies of the first of them.
        std::vector<glm::vec3> rest(lanes, directions[whole]), results(lanes);
        std::vector<float> rest_parameters(lanes, parameters[whole]);
        std::copy(directions.begin() + std::ptrdiff_t(whole), directions.begin() + std::ptrdiff_t(end), rest.begin());
        std::copy(parameters.begin() + std::ptrdiff_t(whole), parameters.begin() + std::ptrdiff_t(end),
                  rest_parameters.begin());
        look_up_shells(shells, &rest[0].x, rest_parameters.data(), &results[0].x, lanes);
        std::copy_n(results.begin(), end - whole, filtered.begin() + std::ptrdiff_t(whole));
    });
}

} // namespace kokage
