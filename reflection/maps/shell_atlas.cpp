#include "reflection/maps/shell_atlas.h"

#include "common/services/error.h"

#include <algorithm>
#include <string>

namespace kokage {
namespace {

/// Calls body(pixel x, pixel y, index of the stored texel) for every texel of the map.
template <typename Body>
void for_each_texel(const ShellMap& map, const ShellAtlas& atlas, const Body& body) {
    for (std::size_t s = 0; s < map.shells().size(); ++s) {
        const ShellMap::Shell& shell = map.shells()[s];
        const int edge = shell.resolution + 2 * map.border();
        std::size_t texel = shell.first;
        for (int face = 0; face < 6; ++face)
            for (int y = 0; y < edge; ++y)
                for (int x = 0; x < edge; ++x, ++texel)
                    body(atlas.places[s].x + face / 2 * edge + x, atlas.places[s].y + face % 2 * edge + y, texel);
    }
}

} // namespace

ShellAtlas shell_atlas(std::span<const ShellMap::Shell> shells, int border) {
    ShellAtlas atlas;
    atlas.places.resize(shells.size());
    std::vector<std::size_t> order(shells.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        order[i] = i;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return shells[a].resolution > shells[b].resolution; });
    const auto edge = [&](std::size_t i) { return shells[i].resolution + 2 * border; };
    // As wide as the two largest side by side, and so about square.
    atlas.width = 3 * edge(order[0]) + (order.size() > 1 ? 3 * edge(order[1]) : 0);
    int x = 0, shelf = 0;
    for (const std::size_t i : order) {
        if (x + 3 * edge(i) > atlas.width) {
            shelf = atlas.height;
            x = 0;
        }
        atlas.places[i] = {x, shelf};
        x += 3 * edge(i);
        atlas.height = std::max(atlas.height, shelf + 2 * edge(i));
    }
    return atlas;
}

Image atlas_image(const ShellMap& map, const ShellAtlas& atlas) {
    Image image(atlas.width, atlas.height, 3);
    const std::size_t each = texel_bytes(map.settings().format);
    for_each_texel(map, atlas, [&](int x, int y, std::size_t texel) {
        const glm::vec3 colour = unpacked_texel(map.texels().data() + texel * each, map.settings().format);
        std::copy_n(&colour.x, 3, image.at(x, y));
    });
    return image;
}

void set_atlas_image(ShellMap& map, const ShellAtlas& atlas, const Image& image) {
    if (image.width != atlas.width || image.height != atlas.height || image.channels != 3)
        throw InputError("shell atlas: the picture is " + std::to_string(image.width) + " x " +
                         std::to_string(image.height) + " pixels of " + std::to_string(image.channels) +
                         " channels, the map's is " + std::to_string(atlas.width) + " x " +
                         std::to_string(atlas.height) + " of 3");
    std::vector<glm::vec3> texels(map.texel_count());
    for_each_texel(map, atlas, [&](int x, int y, std::size_t texel) {
        const float* pixel = image.at(x, y);
        texels[texel] = {pixel[0], pixel[1], pixel[2]};
    });
    map.restore_texels(packed_texels(texels, map.settings().format));
}

std::vector<glm::vec4> shell_uniforms(const ShellMap& map, const ShellAtlas& atlas) {
    std::vector<glm::vec4> uniforms;
    for (std::size_t s = 0; s < map.shells().size(); ++s)
        uniforms.emplace_back(float(atlas.places[s].x), float(atlas.places[s].y), float(map.shells()[s].resolution),
                              map.shells()[s].width);
    return uniforms;
}

} // namespace kokage
