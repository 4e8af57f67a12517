#pragma once
// Closed scenes: nothing gets in or out, so energy can be counted.
#include "tests/unit/foliage/small_trees.h"

namespace kokage::test {

/// Six walls around a centre, fronts inwards, of half edge `half`, a patch each.
inline void add_box(PatchScene& scene, const glm::vec3& centre, float half, std::uint32_t optics = 0) {
    const float e = 2 * half;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (float side : {-1.f, 1.f}) {
            glm::vec3 u(0.f), v(0.f), corner = centre - half;
            u[(axis + 1) % 3] = e;
            v[(axis + 2) % 3] = e;
            corner[axis] = centre[axis] + side * half;
            if (side < 0)
                add_rectangle(scene, corner, u, v, optics);
            else
                add_rectangle(scene, corner, v, u, optics);
        }
}

/// A crown in a closed room whose walls reflect as much as a leaf sends on, and let nothing through.
inline SmallTree crown_in_a_room(std::uint32_t leaves, const Optics& optics) {
    SmallTree room = ball_on_a_skeleton(leaves, 2, optics);
    room.scene.optics.push_back({optics.reflectance + optics.transmittance, glm::vec3(0)});
    add_box(room.scene, {0, 2, 0}, 2.5f, 1);
    return room;
}

} // namespace kokage::test
