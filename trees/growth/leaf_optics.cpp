#include "trees/growth/leaf_optics.h"

#include <array>

namespace kokage {
namespace {

// Our own values in linear Rec.709, chosen within what leaf spectra give: green peaks of 8 to 15 % reflectance and 5 to
// 15 % transmittance of broadleaves, half of the red, a third or less of the blue (Hosgood et al. 1995, LOPEX93;
// Hovi, Raitio and Rautiainen 2017, Silva Fennica 51(4) 7753, 25 boreal species, which differ least in the visible).
// Conifers' needles are darker, and let through far less than they reflect (Lukes et al. 2013, Remote Sensing Letters
// 4:667; Hovi et al. 2022, Silva Fennica 56(2) 10683). The oak's are those that this program began with.
constexpr std::array<LeafOptics, 10> summer = {{
    {{0.070f, 0.118f, 0.034f}, {0.056f, 0.100f, 0.018f}}, // oak
    {{0.058f, 0.108f, 0.030f}, {0.060f, 0.122f, 0.017f}}, // beech: thin, lets much through
    {{0.074f, 0.128f, 0.036f}, {0.062f, 0.115f, 0.018f}}, // birch
    {{0.062f, 0.110f, 0.033f}, {0.058f, 0.112f, 0.017f}}, // maple
    {{0.092f, 0.132f, 0.066f}, {0.044f, 0.080f, 0.018f}}, // willow: silky hairs
    {{0.084f, 0.126f, 0.042f}, {0.058f, 0.102f, 0.018f}}, // aspen
    {{0.064f, 0.098f, 0.048f}, {0.020f, 0.040f, 0.008f}}, // pine: bluish
    {{0.046f, 0.080f, 0.028f}, {0.014f, 0.032f, 0.004f}}, // spruce
    {{0.036f, 0.060f, 0.026f}, {0.008f, 0.016f, 0.003f}}, // cypress
    {{0.064f, 0.110f, 0.034f}, {0.056f, 0.102f, 0.018f}}, // cherry
}};

// Without chlorophyll green and red rise to 20 to 45 % where carotenoids (yellow) stay, and red alone where
// anthocyanins or tannins (red, brown) are made (Gitelson, Merzlyak and Chivkunova 2001, Photochemistry and
// Photobiology 74:38; Archetti et al. 2009, Trends in Ecology and Evolution 24:166, for which trees turn red).
constexpr std::array<LeafOptics, 10> autumn = {{
    {{0.210f, 0.125f, 0.040f}, {0.130f, 0.065f, 0.012f}}, // oak: yellow-brown
    {{0.290f, 0.145f, 0.036f}, {0.220f, 0.092f, 0.012f}}, // beech: copper
    {{0.400f, 0.290f, 0.045f}, {0.300f, 0.205f, 0.014f}}, // birch: yellow
    {{0.390f, 0.190f, 0.035f}, {0.310f, 0.125f, 0.012f}}, // maple: yellow to orange
    {{0.310f, 0.265f, 0.085f}, {0.190f, 0.155f, 0.024f}}, // willow: pale yellow
    {{0.430f, 0.295f, 0.040f}, {0.310f, 0.195f, 0.012f}}, // aspen: gold
    {{0.064f, 0.098f, 0.048f}, {0.020f, 0.040f, 0.008f}}, // conifers stay as they are
    {{0.046f, 0.080f, 0.028f}, {0.014f, 0.032f, 0.004f}},
    {{0.036f, 0.060f, 0.026f}, {0.008f, 0.016f, 0.003f}},
    {{0.330f, 0.105f, 0.040f}, {0.250f, 0.055f, 0.014f}}, // cherry: orange-red
}};

/// Petals of pale pink: white paper with a blush.
constexpr LeafOptics petals{{0.560f, 0.420f, 0.450f}, {0.290f, 0.210f, 0.225f}};

/// Young leaves hold less chlorophyll: brighter, most of all in red and green, and thinner.
LeafOptics young(const LeafOptics& grown, bool needles) {
    if (needles) // this year's tips beside older needles
        return {grown.reflectance * glm::vec3(1.25f, 1.3f, 1.05f), grown.transmittance * glm::vec3(1.3f, 1.4f, 1.0f)};
    return {grown.reflectance * glm::vec3(1.75f, 1.65f, 1.2f), grown.transmittance * glm::vec3(2.0f, 1.9f, 1.25f)};
}

} // namespace

LeafOptics leaf_optics(LeafKind kind, Season season) {
    const std::size_t k = std::size_t(kind);
    switch (season) {
    case Season::blossom:
        return kind == LeafKind::cherry ? petals : young(summer.at(k), has_needles(kind));
    case Season::spring:
        return young(summer.at(k), has_needles(kind));
    case Season::summer:
        return summer.at(k);
    default:
        return autumn.at(k);
    }
}

} // namespace kokage
