#include "reflection/maps/shell_map.h"

#include "common/services/error.h"
#include "common/services/parallel.h"
#include "reflection/maps/face_chart.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace kokage {
namespace {

constexpr int kLeastResolution = 8, kMostResolution = 8192;

void check(const ShellSettings& s) {
    const auto number = [](double value) { return std::to_string(value); };
    const bool phong = s.kind == LobeKind::phong;
    if (!(s.least_parameter <= s.most_parameter && s.least_parameter >= 0 && s.most_parameter <= (phong ? 1e6 : 1.0)))
        throw InputError("shell map from " + number(s.least_parameter) + " to " + number(s.most_parameter) + ": " +
                         (phong ? "exponents rise, from 0 to 1000000" : "roughnesses rise, above 0 up to 1"));
    if (!phong && !(s.least_parameter >= 0.01))
        throw InputError("shell map from roughness " + number(s.least_parameter) + ": ask for at least 0.01");
    if (!(s.shell_ratio > 1 && s.shell_ratio <= 16))
        throw InputError("shell map with shells " + number(s.shell_ratio) +
                         " times apart: ask for 1 to 16, 1 excluded");
    if (!(s.texels_a_width >= 0.25 && s.texels_a_width <= 16))
        throw InputError("shell map of " + number(s.texels_a_width) + " texels a lobe's width: ask for 0.25 to 16");
}

} // namespace

double lobe_spread(const Lobe& lobe) {
    if (lobe.kind == LobeKind::phong)
        return 1 / (lobe.parameter + 1);
    const double alpha = lobe.parameter * lobe.parameter;
    return alpha * alpha;
}

Lobe lobe_of_spread(LobeKind kind, double spread) {
    return {kind, kind == LobeKind::phong ? 1 / spread - 1 : std::sqrt(std::sqrt(spread))};
}

ShellMap::ShellMap(const ShellSettings& settings) : settings_(settings) {
    check(settings);
    layout_.kind = settings.kind;
    const double ends[2] = {lobe_spread({settings.kind, settings.least_parameter}),
                            lobe_spread({settings.kind, settings.most_parameter})};
    const double rough = std::max(ends[0], ends[1]), smooth = std::min(ends[0], ends[1]);
    const int intervals = int(std::ceil(std::log(rough / smooth) / std::log(settings.shell_ratio) - 1e-9));
    for (int i = 0; i <= intervals; ++i) {
        const double spread = i == intervals ? smooth : rough * std::pow(smooth / rough, double(i) / intervals);
        const double wanted = 1 + kPiDouble / 2 * settings.texels_a_width / std::sqrt(spread);
        Shell shell;
        shell.lobe = lobe_of_spread(settings.kind, spread);
        shell.resolution = std::clamp(int(std::ceil(wanted)), kLeastResolution, kMostResolution);
        // The mean over a face of the squared spacing is about (5/6) h².
        const double h = kPiDouble / 2 / (shell.resolution - 1), hat = 5.0 / 6 * h * h / 6;
        shell.texel_lobe = settings.kind == LobeKind::phong ? lobe_of_spread(settings.kind, spread - hat) : shell.lobe;
        shell.first = layout_.size();
        for (int face = 0; face < 6; ++face)
            for (int y = 0; y < shell.resolution; ++y)
                for (int x = 0; x < shell.resolution; ++x) {
                    const double step = 2.0 / (shell.resolution - 1);
                    layout_.directions.push_back(face_direction(face, x * step - 1, y * step - 1));
                }
        layout_.parameters.resize(layout_.size(), float(shell.texel_lobe.parameter));
        shells_.push_back(shell);
    }
    texels_.resize(layout_.size() * texel_bytes(settings.format));
}

void ShellMap::set_texels(std::span<const glm::vec3> filtered) {
    if (filtered.size() != layout_.size())
        throw InputError("shell map: " + std::to_string(filtered.size()) + " texels given, its layout has " +
                         std::to_string(layout_.size()));
    texels_ = packed_texels(filtered, settings_.format);
}

glm::vec3 ShellMap::shell_lookup(const Shell& shell, int face, float u, float v) const {
    const float half = 0.5f * float(shell.resolution - 1), x = half * u + half, y = half * v + half;
    const int last_cell = shell.resolution - 2;
    const int column = std::clamp(int(x), 0, last_cell), row = std::clamp(int(y), 0, last_cell);
    const float fx = x - float(column), fy = y - float(row);
    const std::size_t n = std::size_t(shell.resolution), each = texel_bytes(settings_.format);
    const std::byte* p =
        texels_.data() + each * (shell.first + (std::size_t(face) * n + std::size_t(row)) * n + std::size_t(column));
    const auto texel = [&](std::size_t i) { return unpacked_texel(p + i * each, settings_.format); };
    return glm::mix(glm::mix(texel(0), texel(1), fx), glm::mix(texel(n), texel(n + 1), fx), fy);
}

glm::vec3 ShellMap::lookup(const glm::vec3& direction, double parameter) const {
    const FacePlace place = face_place(direction);
    const double rough = lobe_spread(shells_.front().lobe), smooth = lobe_spread(shells_.back().lobe);
    const double spread = std::clamp(lobe_spread({settings_.kind, parameter}), smooth, rough);
    const int intervals = int(shells_.size()) - 1;
    const double position = intervals == 0 ? 0 : intervals * std::log(spread / rough) / std::log(smooth / rough);
    const int i = std::clamp(int(position), 0, std::max(intervals - 1, 0));
    const Shell& coarse = shells_[std::size_t(i)];
    const glm::vec3 rougher = shell_lookup(coarse, place.face, place.u, place.v);
    if (intervals == 0)
        return rougher;
    const Shell& fine = shells_[std::size_t(i) + 1];
    const double a = lobe_spread(coarse.lobe), b = lobe_spread(fine.lobe);
    const float share = std::clamp(float((a - spread) / (a - b)), 0.f, 1.f);
    return glm::mix(rougher, shell_lookup(fine, place.face, place.u, place.v), share);
}

void ShellMap::lookup(std::span<const glm::vec3> directions, std::span<const float> parameters,
                      std::span<glm::vec3> filtered) const {
    parallel_blocks(directions.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            filtered[i] = lookup(directions[i], double(parameters[i]));
    });
}

} // namespace kokage
