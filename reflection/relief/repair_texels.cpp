#include "reflection/relief/repair_texels.h"
#include "reflection/relief/bilinear_cell.h"

#include <cmath>
#include <limits>
#include <vector>

namespace kokage {
namespace {

template <class Visit>
void visit_neighbors(std::size_t texel, int width, int height, HeightWrap wrap, Visit&& visit) {
    const int x = int(texel % std::size_t(width)), y = int(texel / std::size_t(width));
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
            const std::size_t neighbor = std::size_t(texel_index(y + dy, height, wrap)) * std::size_t(width) +
                                         std::size_t(texel_index(x + dx, width, wrap));
            if (neighbor != texel)
                visit(neighbor);
        }
}

} // namespace

std::size_t repair_texels(std::span<float> values, int width, int height, HeightWrap wrap) {
    enum class State : unsigned char { good, bad, in_layer };
    std::vector<State> states(values.size(), State::good);
    std::size_t bad = 0;
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!std::isfinite(values[i])) {
            states[i] = State::bad;
            ++bad;
        }
    if (bad == 0 || bad == values.size())
        return bad;
    std::vector<std::size_t> layer, next;
    for (std::size_t i = 0; i < values.size(); ++i)
        if (states[i] == State::bad)
            visit_neighbors(i, width, height, wrap, [&](std::size_t neighbor) {
                if (states[neighbor] == State::good && states[i] == State::bad) {
                    states[i] = State::in_layer;
                    layer.push_back(i);
                }
            });
    while (!layer.empty()) {
        for (const std::size_t i : layer) {
            double sum = 0;
            int count = 0;
            visit_neighbors(i, width, height, wrap, [&](std::size_t neighbor) {
                if (states[neighbor] == State::good) {
                    sum += double(values[neighbor]);
                    ++count;
                }
            });
            values[i] = float(sum / count);
        }
        for (const std::size_t i : layer)
            states[i] = State::good;
        next.clear();
        for (const std::size_t i : layer)
            visit_neighbors(i, width, height, wrap, [&](std::size_t neighbor) {
                if (states[neighbor] == State::bad) {
                    states[neighbor] = State::in_layer;
                    next.push_back(neighbor);
                }
            });
        layer.swap(next);
    }
    return bad;
}

} // namespace kokage
