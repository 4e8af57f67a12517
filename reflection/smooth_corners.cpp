#include "reflection/smooth_corners.h"
#include "common/services/random.h"

#include <algorithm>
#include <cstring>
#include <unordered_map>

namespace kokage {
namespace {

constexpr float kLeastCosine = 0.98f; ///< of the normals of one corner: some 11 degrees
constexpr std::uint32_t kNone = 0xffffffffu;

struct CornerPlace {
    glm::vec3 position{0.f};
    std::uint32_t look = 0;
    bool operator==(const CornerPlace&) const = default;
};

struct CornerPlaceHash {
    std::size_t operator()(const CornerPlace& place) const {
        const glm::vec3 position = place.position + 0.f; // -0 is 0
        std::array<std::uint32_t, 3> bits;
        std::memcpy(bits.data(), &position, sizeof(bits));
        return hash64(hash64(hash64(hash64(bits[0]) + bits[1]) + bits[2]) + place.look);
    }
};

class Joining {
  public:
    explicit Joining(const ShadedScene& scene) : scene_(scene), of_position_(scene.patches->positions.size(), kNone) {}

    std::uint32_t corner(std::uint32_t position, std::uint32_t look) {
        std::uint32_t& known = of_position_[position];
        if (known == kNone || corners_[known].look != look)
            known = found(position, look);
        return known;
    }
    std::uint32_t count() const { return std::uint32_t(corners_.size()); }

  private:
    struct Corner {
        glm::vec3 normal{0.f};
        std::uint32_t look = 0, next = kNone; ///< at the same place
    };

    std::uint32_t found(std::uint32_t position, std::uint32_t look) {
        const glm::vec3 normal = scene_.normals.empty() ? glm::vec3(0.f) : scene_.normals[position];
        std::uint32_t* link =
            &first_.try_emplace(CornerPlace{scene_.patches->positions[position], look}, kNone).first->second;
        while (*link != kNone) {
            Corner& corner = corners_[*link];
            if (corner.normal == normal || glm::dot(corner.normal, normal) > kLeastCosine)
                return *link;
            link = &corner.next;
        }
        const std::uint32_t added = *link = count();
        corners_.push_back({normal, look, kNone});
        return added;
    }

    const ShadedScene& scene_;
    std::vector<std::uint32_t> of_position_;
    std::vector<Corner> corners_;
    std::unordered_map<CornerPlace, std::uint32_t, CornerPlaceHash> first_; ///< corner at a place
};

} // namespace

SmoothCorners smooth_corners(const ShadedScene& scene) {
    SmoothCorners result;
    if (std::none_of(scene.looks.begin(), scene.looks.end(), [](const auto& look) { return look.smooth_normals; }))
        return result;
    const std::vector<glm::uvec3>& triangles = scene.patches->triangles;
    result.of_triangle.resize(triangles.size());
    Joining joining(scene);
    for (std::size_t t = 0; t < triangles.size(); ++t)
        if (const std::uint32_t look = scene.triangle_look[t]; scene.looks[look].smooth_normals)
            for (std::size_t k = 0; k < 3; ++k)
                result.of_triangle[t][k] = joining.corner(triangles[t][k], look);
    result.count = joining.count();
    return result;
}

} // namespace kokage
