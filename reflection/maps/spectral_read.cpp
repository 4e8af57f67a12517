#include "reflection/maps/spectral_read.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kokage {

TexelPlace texel_place(const glm::vec3& direction, const ShellMix& mix, std::uint32_t texel) {
    const glm::dvec3 d(direction);
    double turn = std::atan2(d.z, d.x) / (2 * kPiDouble);
    turn -= std::floor(turn);
    const double polar = std::atan2(std::hypot(d.x, d.z), d.y) / kPiDouble;
    return {float(turn) < 1 ? float(turn) : 0.f, float(std::min(polar, 1.0)), mix.weights, texel,
            std::uint32_t(mix.first)};
}

float read_texels(std::span<const TexelPlace> places, std::span<const RingGrid> grids, std::size_t grids_a_texel,
                  float scale, std::span<glm::vec3> filtered) {
    float least = std::numeric_limits<float>::max();
    for (const TexelPlace& place : places) {
        glm::vec3 sum(0);
        for (std::size_t k = 0; k < grids_a_texel; ++k) {
            const RingGrid& grid = grids[place.first + k];
            const float x = place.turn * float(grid.columns), y = place.polar * float(grid.rings) - 0.5f;
            const int column = int(x), ring = int(y + 1) - 1;
            const float t = x - float(column), s = y - float(ring), t1 = 1 - t, s1 = 1 - s;
            const float across[4] = {t1 * t1 * t1, 4 - 6 * t * t + 3 * t * t * t, 4 - 6 * t1 * t1 + 3 * t1 * t1 * t1,
                                     t * t * t};
            const float down[4] = {s1 * s1 * s1, 4 - 6 * s * s + 3 * s * s * s, 4 - 6 * s1 * s1 + 3 * s1 * s1 * s1,
                                   s * s * s};
            glm::vec3 read(0);
            for (int j = 0; j < 4; ++j) {
                const glm::vec4* row = &grid.at(ring - 1 + j, column - 1);
                glm::vec4 line(0);
                for (int i = 0; i < 4; ++i)
                    line += across[i] * row[i];
                read += down[j] * glm::vec3(line);
            }
            sum += place.weights[k] / 36 * read;
        }
        least = std::min({least, sum.r, sum.g, sum.b});
        filtered[place.texel] = scale * glm::max(sum, glm::vec3(0));
    }
    return least;
}

} // namespace kokage
