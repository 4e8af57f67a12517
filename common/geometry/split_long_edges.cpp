#include "common/geometry/split_long_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace kokage {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

class Splitting {
  public:
    Splitting(double longest, std::vector<glm::vec3>& positions, std::vector<Edge>& middles)
        : longest_(longest), positions_(positions), middles_(middles) {}

    /// The pieces of a triangle; one if no edge is long.
    void split(const glm::uvec3& triangle, std::vector<glm::uvec3>& pieces) {
        std::array<std::uint32_t, 3> middle{};
        int count = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            middle[k] = middle_of(triangle[k], triangle[(k + 1) % 3]);
            count += middle[k] != kNone;
        }
        if (count == 0) {
            pieces.push_back(triangle);
            return;
        }
        if (count == 3) {
            pieces.insert(pieces.end(), {{triangle[0], middle[0], middle[2]},
                                         {middle[0], triangle[1], middle[1]},
                                         {middle[2], middle[1], triangle[2]},
                                         {middle[0], middle[1], middle[2]}});
            return;
        }
        // Turned so that the first edge is split, and with two, that the third is not.
        std::size_t first = 0;
        while (middle[first] == kNone || (count == 2 && middle[(first + 2) % 3] != kNone))
            ++first;
        const std::uint32_t a = triangle[first], b = triangle[(first + 1) % 3], c = triangle[(first + 2) % 3];
        const std::uint32_t ab = middle[first], bc = middle[(first + 1) % 3];
        if (count == 1)
            pieces.insert(pieces.end(), {{a, ab, c}, {ab, b, c}});
        else
            pieces.insert(pieces.end(), {{a, ab, bc}, {ab, b, bc}, {a, bc, c}});
    }

  private:
    static constexpr std::uint32_t kNone = ~0u;

    std::uint32_t middle_of(std::uint32_t a, std::uint32_t b) {
        const glm::dvec3 apart = glm::dvec3(positions_[a]) - glm::dvec3(positions_[b]);
        if (!(glm::length(apart) > longest_))
            return kNone;
        const Edge edge = std::minmax(a, b);
        const auto [found, is_new] = middle_.try_emplace(edge, std::uint32_t(positions_.size()));
        if (is_new) {
            positions_.push_back(0.5f * (positions_[a] + positions_[b]));
            middles_.push_back(edge);
        }
        return found->second;
    }

    double longest_;
    std::vector<glm::vec3>& positions_;
    std::vector<Edge>& middles_;
    std::map<Edge, std::uint32_t> middle_;
};

} // namespace

void split_long_edges(double longest, std::size_t most, std::vector<glm::vec3>& positions,
                      std::vector<glm::uvec3>& triangles, std::vector<std::pair<std::uint32_t, std::uint32_t>>& middles,
                      std::vector<std::uint32_t>& source) {
    source.resize(triangles.size());
    for (std::uint32_t t = 0; t < source.size(); ++t)
        source[t] = t;
    for (bool changed = longest > 0; changed && triangles.size() <= most;) {
        Splitting splitting(longest, positions, middles);
        std::vector<glm::uvec3> pieces;
        std::vector<std::uint32_t> from;
        for (std::size_t t = 0; t < triangles.size(); ++t) {
            splitting.split(triangles[t], pieces);
            from.resize(pieces.size(), source[t]);
        }
        changed = pieces.size() != triangles.size();
        triangles = std::move(pieces);
        source = std::move(from);
    }
}

} // namespace kokage
