#include "trees/growth/young_tree.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

constexpr double seedling_leaves = 50;

/// From the grown tree's value to a seedling's.
class Blend {
  public:
    explicit Blend(double youth) : youth_(youth) {}
    void draw(double& value, double to) const { value += youth_ * (to - value); }
    void at_least(double& value, double to) const { draw(value, std::max(value, to)); }
    void at_most(double& value, double to) const { draw(value, std::min(value, to)); }

  private:
    double youth_;
};

} // namespace

double youth(const GrowthParameters& p) {
    if (p.leaves >= p.young_below)
        return 0;
    const double range = std::max(2.0, p.young_below / seedling_leaves);
    return std::min(1.0, std::log(p.young_below / double(p.leaves)) / std::log(range));
}

GrowthParameters at_its_age(const GrowthParameters& parameters) {
    GrowthParameters p = parameters;
    const double young = youth(p);
    if (young <= 0)
        return p;
    const Blend blend(young);
    // Few leaves stand apart; a leaf area as dense as in a grown column of cypress takes years.
    p.leaf_area_index *= std::pow(std::min(1 / 2.4, 6 / p.leaf_area_index), young);
    blend.at_least(p.height_to_width, 1.6);
    blend.at_most(p.height_to_width, 4.5);
    blend.at_most(p.crown_base, 0.15);
    blend.at_most(p.crown_widest, 0.35);
    blend.at_least(p.crown_bottom, 0.5);
    blend.at_most(p.crown_roundness, 2);
    blend.at_least(p.crown_underside, 1.6);
    blend.at_most(p.crown_shell, 1);
    blend.draw(p.crown_lobe_depth, 0);
    blend.draw(p.crown_clumping, 0);
    blend.at_least(p.trunk_reach, 0.97);
    blend.draw(p.limb_first, 0.25);
    blend.draw(p.limb_last, 0.8);
    blend.at_least(p.limb_elevation_low, 20);
    blend.at_most(p.limb_bare, 0.2);
    blend.draw(p.twig_sag, 0);
    blend.draw(p.shoot_hang, 0.4 * p.shoot_hang);
    // Shoots are no longer than their leaves need, and as many more.
    const double shoot_length = p.shoot_length;
    blend.at_most(p.shoot_length, 1.6 * p.leaf_length);
    p.leaves_per_shoot = std::max(1.0, p.leaves_per_shoot * p.shoot_length / shoot_length);
    p.shoot_length *= std::clamp(p.leaves / p.leaves_per_shoot, 0.25, 1.0);
    blend.draw(p.shoot_radius, 0.6 * p.shoot_radius);
    // No more limbs than shoots can stand on.
    p.limbs = std::min(p.limbs, int(std::ceil(p.leaves / p.leaves_per_shoot / 3)));
    // Few limbs in whorls of many would leave the stem bare between: a handful of pairs or whorls at least.
    const int whorl = std::clamp(p.limbs / 4, std::min(2, p.limb_whorl), p.limb_whorl);
    if (whorl < p.limb_whorl)
        p.limb_divergence = 180.0 / whorl;
    p.limb_whorl = whorl;
    return p;
}

} // namespace kokage
