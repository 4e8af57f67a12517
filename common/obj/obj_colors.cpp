#include "common/obj/obj_colors.h"

#include "common/scene/image_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace kokage {
namespace {

constexpr std::string_view kBlanks = " \t\r";

/// Takes the next word off a line; empty at its end.
std::string_view next_word(std::string_view& line) {
    line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
    const std::string_view word = line.substr(0, line.find_first_of(kBlanks));
    line.remove_prefix(word.size());
    return word;
}

} // namespace

void ObjVertexColors::read_line(std::string_view line) {
    if (next_word(line) != "v")
        return;
    const std::size_t vertex = vertices_++;
    std::array<std::string_view, 8> words; // behind x y z: w, or r g b, or w r g b (w divides nothing in practice)
    std::size_t count = 0;
    for (std::string_view word = next_word(line); !word.empty() && count < words.size(); word = next_word(line))
        words[count++] = word;
    if (count != 6 && count != 7)
        return;
    glm::vec3 color(1.f);
    for (std::size_t c = 0; c < 3; ++c) {
        const std::string_view word = words[count - 3 + c];
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), color[c]);
        if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(color[c]))
            return;
        color[c] = std::max(color[c], 0.f);
        largest_ = std::max(largest_, color[c]);
    }
    colors_.resize(vertex, glm::vec3(-1.f));
    colors_.push_back(color);
    any_ = true;
}

glm::vec3 ObjVertexColors::of_vertex(std::size_t vertex) const {
    if (vertex >= colors_.size() || colors_[vertex].r < 0)
        return glm::vec3(1.f);
    const glm::vec3 srgb = glm::min(colors_[vertex] / (largest_ > 1 ? 255.f : 1.f), 1.f);
    return {linear_from_srgb(srgb.r), linear_from_srgb(srgb.g), linear_from_srgb(srgb.b)};
}

} // namespace kokage
