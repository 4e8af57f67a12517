#pragma once
// The patterns of bark, point by point. Used by bark_image alone.
#include "common/types.h"
#include "trees/growth/bark_kind.h"

#include <vector>

namespace kokage {

class BarkPattern {
  public:
    BarkPattern(BarkKind kind, float age);

    struct Point {
        float height = 0.5f;  ///< in any range
        glm::vec3 color{1.f}; ///< in any scale: the image is scaled to its mean
    };
    /// At a point of the tile, both coordinates in 0..1; the pattern repeats beyond.
    Point at(const glm::vec2& uv) const;

  private:
    /// A pore: a raised or dark mark on smooth bark.
    struct Lenticel {
        glm::vec2 centre, half_size;
    };
    enum class LenticelShape { dash, diamond };
    /// 1 inside a lenticel, 0 outside, soft at the edge; across tile borders.
    float lenticel(const glm::vec2& uv, LenticelShape shape) const;
    void scatter(int rows, int count, glm::vec2 smallest, glm::vec2 largest, std::uint64_t seed);

    Point oak(glm::vec2 uv) const;
    Point beech(glm::vec2 uv) const;
    Point birch(glm::vec2 uv) const;
    Point maple(glm::vec2 uv) const;
    Point willow(glm::vec2 uv) const;
    Point aspen(glm::vec2 uv) const;
    Point pine(glm::vec2 uv) const;
    Point spruce(glm::vec2 uv) const;
    Point cypress(glm::vec2 uv) const;
    Point cherry(glm::vec2 uv) const;

    BarkKind kind_;
    float age_;
    std::vector<Lenticel> lenticels_;
    /// Lenticels by the horizontal band of the tile that they reach into.
    static constexpr int band_count = 32;
    std::vector<std::vector<std::uint32_t>> bands_;
};

} // namespace kokage
