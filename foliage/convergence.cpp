#include "foliage/convergence.h"
#include "common/services/parallel.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace kokage {

namespace {

constexpr std::size_t kWindow = 5;      // bounces over which the rate is averaged
constexpr int kMostBounces = 500;       // when none is asked for
constexpr double kTooBright = 1e33;     // changes above this could leave the range of float at the next bounce
constexpr double kAsGoodAsOne = 0.9999; // a factor per bounce from here on is no contraction that ends in a lifetime
constexpr double kRounding = 1e-6;      // changes of this share of the radiance are rounding, and need not shrink

double largest(const glm::vec3& v) {
    return std::max({v.r, v.g, v.b});
}

} // namespace

BounceChange compare_bounces(const SideRadiance& before, const SideRadiance& after) {
    constexpr std::size_t kBlock = 4096;
    const std::size_t count = after.front.size();
    std::vector<BounceChange> blocks((count + kBlock - 1) / kBlock);
    parallel_blocks(count, kBlock, [&](std::size_t begin, std::size_t end) {
        BounceChange& block = blocks[begin / kBlock];
        for (std::size_t i = begin; i < end; ++i) {
            block.largest_change = std::max({block.largest_change, largest(glm::abs(after.front[i] - before.front[i])),
                                             largest(glm::abs(after.back[i] - before.back[i]))});
            block.largest_radiance =
                std::max({block.largest_radiance, largest(after.front[i]), largest(after.back[i])});
        }
    });
    BounceChange all;
    for (const BounceChange& block : blocks) {
        all.largest_change = std::max(all.largest_change, block.largest_change);
        all.largest_radiance = std::max(all.largest_radiance, block.largest_radiance);
    }
    return all;
}

bool Convergence::another(const BounceChange& change) {
    changes_.push_back(change.largest_change);
    residuals_.push_back(change.largest_change > 0 ? change.largest_change / change.largest_radiance : 0);
    if (change.largest_change == 0)
        return false;
    const int bounces = int(changes_.size());
    if (max_bounces_ > 0) {
        stopped_short_ = bounces < max_bounces_ && change.largest_change > kTooBright;
        return bounces < max_bounces_ && !stopped_short_;
    }
    if (residuals_.back() <= residual_)
        return false;
    stopped_short_ = diverges() || bounces >= kMostBounces || change.largest_change > kTooBright;
    return !stopped_short_;
}

std::optional<double> Convergence::rate() const {
    if (changes_.size() < 3 || changes_.back() == 0)
        return {};
    const std::size_t steps = std::min(kWindow, changes_.size() - 2); // the first change is the light itself
    return std::pow(changes_.back() / changes_[changes_.size() - 1 - steps], 1.0 / double(steps));
}

bool Convergence::diverges() const {
    const std::optional<double> factor = rate();
    return factor && *factor >= kAsGoodAsOne && changes_.size() >= kWindow + 2 && residuals_.back() > kRounding;
}

std::string Convergence::warning() const {
    char text[240] = "";
    if (diverges())
        std::snprintf(
            text, sizeof text,
            "the iteration does not contract: each bounce changed the shading %.3f times as much as the one before; "
            "what is given is bounce %zu of a series without a limit (fewer bands or a lower rho + tau would mend it)",
            *rate(), changes_.size());
    else if (stopped_short_)
        std::snprintf(text, sizeof text, "the iteration was stopped after %zu bounces with a residual of %.2g",
                      changes_.size(), residuals_.back());
    return text;
}

} // namespace kokage
