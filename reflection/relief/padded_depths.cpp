#include "reflection/relief/padded_depths.h"
#include "common/services/error.h"
#include "reflection/relief/bilinear_cell.h"

namespace kokage {

PaddedDepths::PaddedDepths(const HeightField& field) : width(field.width), height(field.height), wrap(field.wrap) {
    constexpr int most = 32767;
    const std::string size = std::to_string(width) + " x " + std::to_string(height);
    if (width < 1 || height < 1 || width > most || height > most ||
        field.depths.size() != std::size_t(width) * std::size_t(height))
        throw InputError("a height field of " + size + " texels can't be traced; give one of 1 to " +
                         std::to_string(most) + " texels on each side");
    depths.reserve(std::size_t(width + 1) * std::size_t(height + 1));
    for (int y = 0; y <= height; ++y)
        for (int x = 0; x <= width; ++x) {
            const float depth = field.depth(texel_index(x, width, wrap), texel_index(y, height, wrap));
            if (!(depth >= 0 && depth <= 1))
                throw InputError("a height field has depth " + std::to_string(depth) + " at texel (" +
                                 std::to_string(x) + ", " + std::to_string(y) + "); give depths of 0 to 1");
            depths.push_back(depth);
        }
}

} // namespace kokage
