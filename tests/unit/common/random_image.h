#pragma once
#include "common/scene/image.h"
#include "common/services/random.h"

namespace kokage::test {

/// Three channels, evenly spread over 0..1, no pixel like another.
inline Image random_image(int width, int height, std::uint64_t seed) {
    Image image(width, height, 3);
    Random random(seed);
    for (float& value : image.pixels)
        value = random.uniform();
    return image;
}

} // namespace kokage::test
