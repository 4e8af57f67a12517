#include "common/environment/analytic_sky.h"
#include "common/services/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>

namespace kokage {
namespace {

// Preetham, Shirley, Smits 1999 = [P] below.

constexpr double degrees = kPiDouble / 180;
constexpr double cd_per_unit = 1e4; ///< radiance 1 = 10,000 cd/m^2

std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", value);
    return text;
}

void check(const Daylight& daylight) {
    if (!std::isfinite(daylight.sun_azimuth_degrees))
        throw InputError("analytic sky: the sun's azimuth must be a finite number of degrees");
    if (!(std::abs(daylight.sun_elevation_degrees) <= 90))
        throw InputError("analytic sky: the sun's elevation is " + number(daylight.sun_elevation_degrees) +
                         "; it must be between -90 and 90 degrees");
    if (!(daylight.turbidity >= 1.7 && daylight.turbidity <= 10))
        throw InputError("analytic sky: turbidity is " + number(daylight.turbidity) +
                         "; it must be between 1.7 and 10");
    if (daylight.width < 4 || daylight.width > 32768)
        throw InputError("analytic sky: width is " + std::to_string(daylight.width) +
                         "; it must be between 4 and 32768");
}

glm::dvec3 rgb_from_xyz(const glm::dvec3& xyz) {
    // Rec.709 primaries, white D65 (IEC 61966-2-1).
    return {3.2404542 * xyz.x - 1.5371385 * xyz.y - 0.4985314 * xyz.z,
            -0.9692660 * xyz.x + 1.8760108 * xyz.y + 0.0415560 * xyz.z,
            0.0556434 * xyz.x - 0.2040259 * xyz.y + 1.0572252 * xyz.z};
}

/// The five coefficients of the distribution of Perez et al. 1993; [P] appendix A.2, linear in turbidity.
struct Perez {
    double a, b, c, d, e;
    double operator()(double cos_theta, double gamma) const {
        // The zenith angle comes near 90 degrees where exp(b / cos) goes to 0, as b < 0.
        const double cos_gamma = std::cos(gamma);
        return (1 + a * std::exp(b / std::max(cos_theta, 1e-4))) *
               (1 + c * std::exp(d * gamma) + e * cos_gamma * cos_gamma);
    }
};

/// The sky's model for one position of the sun, at or above the horizon.
class SkyModel {
  public:
    SkyModel(double turbidity, double sun_zenith_angle) {
        const double t = turbidity, s = sun_zenith_angle;
        luminance_ = {0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251, 0.1206 * t - 2.5771,
                      -0.0670 * t + 0.3703};
        x_ = {-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125, -0.0641 * t - 0.8989,
              -0.0033 * t + 0.0452};
        y_ = {-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102, -0.0441 * t - 1.6537,
              -0.0109 * t + 0.0529};
        // [P] appendix A.2: zenith luminance in kcd/m^2 and chromaticity.
        const double chi = (4.0 / 9.0 - t / 120) * (kPiDouble - 2 * s);
        zenith_luminance_ = ((4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192) * 1000;
        auto polynomial = [&](const std::array<double, 12>& m) {
            auto cubic = [&](std::size_t i) { return ((m[i] * s + m[i + 1]) * s + m[i + 2]) * s + m[i + 3]; };
            return t * t * cubic(0) + t * cubic(4) + cubic(8);
        };
        zenith_x_ = polynomial(
            {0.00166, -0.00375, 0.00209, 0, -0.02903, 0.06377, -0.03202, 0.00394, 0.11693, -0.21196, 0.06052, 0.25886});
        zenith_y_ = polynomial(
            {0.00275, -0.00610, 0.00317, 0, -0.04214, 0.08970, -0.04153, 0.00516, 0.15346, -0.26756, 0.06670, 0.26688});
        at_zenith_ = {luminance_(1, s), x_(1, s), y_(1, s)};
    }

    /// Linear Rec.709 in our unit; [P] section 3 eq 4 and what follows it.
    glm::dvec3 radiance(double cos_theta, double gamma) const {
        const double y_luminance = std::max(0.0, zenith_luminance_ * luminance_(cos_theta, gamma) / at_zenith_.x);
        const double x = zenith_x_ * x_(cos_theta, gamma) / at_zenith_.y,
                     y = std::max(1e-3, zenith_y_ * y_(cos_theta, gamma) / at_zenith_.z);
        return glm::max(glm::dvec3(0),
                        rgb_from_xyz(glm::dvec3(x / y, 1, (1 - x - y) / y) * (y_luminance / cd_per_unit)));
    }

  private:
    Perez luminance_{}, x_{}, y_{};
    double zenith_luminance_ = 0, zenith_x_ = 0, zenith_y_ = 0;
    glm::dvec3 at_zenith_{0.0};
};

/// Our extension for a sun below the horizon (see the header): 1 at the horizon.
double twilight(double sun_elevation_degrees) {
    return std::pow(10.0, std::clamp(sun_elevation_degrees, -18.0, 0.0) / 2.9);
}

/// Share of the sun's disc above a flat horizon: a circle's segment.
double visible_share_of_sun(double sun_elevation_degrees) {
    const double h = std::clamp(sun_elevation_degrees / sun_half_angle_degrees, -1.0, 1.0);
    return 0.5 + (std::asin(h) + h * std::sqrt(1 - h * h)) / kPiDouble;
}

double piecewise_linear(std::span<const double> x, std::span<const double> y, double at) {
    if (at <= x.front())
        return y.front();
    for (std::size_t i = 1; i < x.size(); ++i)
        if (at <= x[i])
            return y[i - 1] + (y[i] - y[i - 1]) * (at - x[i - 1]) / (x[i] - x[i - 1]);
    return y.back();
}

// [P] appendix A.1, table 2 (its source: Iqbal, An Introduction to Solar Radiation, 1983): the sun's radiance outside
// of the atmosphere in W m^-2 nm^-1 sr^-1 / 100, 380 ... 750 nm by 10, and absorption of ozone, mixed gases and water
// vapour.
constexpr std::array<double, 38> solar_radiance = {165.5, 162.3, 211.2, 258.8, 258.2, 242.3, 267.6, 296.6, 305.4, 300.6,
                                                   306.6, 288.3, 287.1, 278.2, 271.0, 272.3, 263.6, 255.0, 250.6, 253.1,
                                                   253.5, 251.3, 246.3, 241.7, 236.8, 232.1, 228.2, 223.4, 219.7, 215.3,
                                                   211.0, 207.3, 202.4, 198.7, 194.3, 190.7, 186.3, 182.6};
constexpr std::array<double, 48> ozone_nm = {355, 445, 450, 455, 460, 465, 470, 475, 480, 485, 490, 495,
                                             500, 505, 510, 515, 520, 525, 530, 535, 540, 545, 550, 555,
                                             560, 565, 570, 575, 580, 585, 590, 595, 600, 605, 610, 620,
                                             630, 640, 650, 660, 670, 680, 690, 700, 710, 720, 730, 740};
constexpr std::array<double, 48> ozone = {.0,   .003, .003, .004, .006, .008, .009, .012, .014, .017, .021, .025,
                                          .03,  .035, .04,  .045, .048, .057, .063, .07,  .075, .08,  .085, .095,
                                          .103, .110, .12,  .122, .12,  .118, .115, .12,  .125, .130, .12,  .105,
                                          .09,  .079, .067, .057, .048, .036, .028, .023, .018, .014, .011, .010};
constexpr std::array<double, 4> gas_nm = {759, 760, 770, 771}, gas = {0, 3.0, 0.210, 0};
constexpr std::array<double, 8> water_nm = {689, 690, 700, 710, 720, 730, 740, 750},
                                water = {0, 0.016, 0.024, 0.0125, 1.0, 0.87, 0.061, 0.001};

/// CIE 1931 colour matching by the multi-lobe fit of Wyman, Sloan, Shirley 2013, JCGT 2(2), eq 4 and table 1.
glm::dvec3 color_matching(double nm) {
    auto lobe = [&](double height, double mean, double below, double above) {
        const double t = (nm - mean) / (nm < mean ? below : above);
        return height * std::exp(-0.5 * t * t);
    };
    return {lobe(1.056, 599.8, 37.9, 31.0) + lobe(0.362, 442.0, 16.0, 26.7) + lobe(-0.065, 501.1, 20.4, 26.2),
            lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1),
            lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8)};
}

/// Share of sun light that passes the atmosphere; [P] appendix A.1.
double transmittance(double nm, double turbidity, double optical_mass) {
    const double m = optical_mass, micrometres = nm / 1000;
    const double aerosol = 0.04608365822050 * turbidity - 0.04586025928522;
    const double k_gas = piecewise_linear(gas_nm, gas, nm), k_water = piecewise_linear(water_nm, water, nm);
    constexpr double ozone_cm = 0.35, water_cm = 2;
    const double depth = 0.008735 * std::pow(micrometres, -4.08) * m + aerosol * std::pow(micrometres, -1.3) * m +
                         piecewise_linear(ozone_nm, ozone, nm) * ozone_cm * m +
                         1.41 * k_gas * m / std::pow(1 + 118.93 * k_gas * m, 0.45) +
                         0.2385 * k_water * water_cm * m / std::pow(1 + 20.07 * k_water * water_cm * m, 0.45);
    return std::exp(-depth);
}

} // namespace

glm::vec3 direction_from_azimuth_elevation(double azimuth_degrees, double elevation_degrees) {
    const double azimuth = std::remainder(azimuth_degrees, 360.0) * degrees, elevation = elevation_degrees * degrees;
    return glm::vec3(glm::normalize(glm::dvec3(std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                                               -std::cos(elevation) * std::cos(azimuth))));
}

glm::vec3 sun_irradiance(const Daylight& daylight) {
    check(daylight);
    const double share = visible_share_of_sun(daylight.sun_elevation_degrees);
    if (share <= 0)
        return glm::vec3(0);
    const double zenith_degrees = 90 - std::max(0.0, daylight.sun_elevation_degrees);
    // Relative optical mass: Kasten 1966, as in [P] appendix A.1.
    const double mass = 1 / (std::cos(zenith_degrees * degrees) + 0.15 * std::pow(93.885 - zenith_degrees, -1.253));
    glm::dvec3 xyz(0);
    for (std::size_t i = 0; i < solar_radiance.size(); ++i) {
        const double nm = 380 + 10 * double(i);
        xyz += 10 * 100 * solar_radiance[i] * transmittance(nm, daylight.turbidity, mass) * color_matching(nm);
    }
    const double half_sine = std::sin(0.5 * sun_half_angle_degrees * degrees),
                 solid_angle = 4 * kPiDouble * half_sine * half_sine;
    constexpr double lumen_per_watt = 683;
    return glm::vec3(glm::max(glm::dvec3(0), rgb_from_xyz(xyz * (lumen_per_watt * solid_angle * share / cd_per_unit))));
}

glm::vec3 daylight_radiance(const Daylight& daylight, const glm::vec3& direction) {
    check(daylight);
    if (direction.y <= 0)
        return glm::vec3(0);
    const double elevation = std::max(0.0, daylight.sun_elevation_degrees);
    const glm::dvec3 sun(direction_from_azimuth_elevation(daylight.sun_azimuth_degrees, elevation));
    const SkyModel model(daylight.turbidity, (90 - elevation) * degrees);
    const double gamma = std::acos(std::clamp(glm::dot(sun, glm::dvec3(direction)), -1.0, 1.0));
    return glm::vec3(twilight(daylight.sun_elevation_degrees) * model.radiance(double(direction.y), gamma));
}

Environment analytic_sky(const Daylight& daylight) {
    check(daylight);
    const double elevation = std::max(0.0, daylight.sun_elevation_degrees),
                 fade = twilight(daylight.sun_elevation_degrees);
    const glm::dvec3 sun(direction_from_azimuth_elevation(daylight.sun_azimuth_degrees, elevation));
    const SkyModel model(daylight.turbidity, (90 - elevation) * degrees);
    Environment environment;
    environment.has_lower_half = false;
    environment.description = "analytic sky: sun at azimuth " + number(daylight.sun_azimuth_degrees) + ", elevation " +
                              number(daylight.sun_elevation_degrees) + " degrees, turbidity " +
                              number(daylight.turbidity);
    const int height = std::max(2, daylight.width / 4 * 2);
    environment.remainder = Image(daylight.width, height, 3);
    for (int y = 0; y < height / 2; ++y)
        for (int x = 0; x < daylight.width; ++x) {
            const glm::dvec3 direction(direction_from_lat_long(
                {(float(x) + 0.5f) / float(daylight.width), (float(y) + 0.5f) / float(height)}));
            const double gamma = std::acos(std::clamp(glm::dot(sun, direction), -1.0, 1.0));
            const glm::dvec3 radiance = fade * model.radiance(direction.y, gamma);
            for (int c = 0; c < 3; ++c)
                environment.remainder.at(x, y)[c] = float(radiance[glm::length_t(c)]);
        }
    DistantLight light;
    light.name = "sun";
    light.direction = glm::vec3(sun);
    light.half_angle = float(sun_half_angle_degrees * degrees);
    light.irradiance = sun_irradiance(daylight);
    if (light.irradiance != glm::vec3(0))
        environment.distant_lights.push_back(light);
    return environment;
}

namespace {

void check_radiance(const glm::vec3& radiance) {
    for (int c = 0; c < 3; ++c)
        if (!(radiance[glm::length_t(c)] >= 0 && radiance[glm::length_t(c)] <= 1e32f))
            throw InputError("environment: radiance " + number(double(radiance[glm::length_t(c)])) +
                             " must be finite and not negative");
}

} // namespace

Environment constant_environment(const glm::vec3& radiance) {
    check_radiance(radiance);
    Environment environment;
    environment.remainder = Image(1, 1, 3);
    std::copy_n(&radiance.x, 3, environment.remainder.at(0, 0));
    environment.description = "constant radiance " + number(double(radiance.r)) + ", " + number(double(radiance.g)) +
                              ", " + number(double(radiance.b));
    return environment;
}

Environment gradient_environment(const glm::vec3& zenith, const glm::vec3& horizon, const glm::vec3& nadir) {
    for (const glm::vec3& radiance : {zenith, horizon, nadir})
        check_radiance(radiance);
    Environment environment;
    environment.remainder = Image(4, 512, 3);
    for (int y = 0; y < 512; ++y) {
        const float sine = std::cos((float(y) + 0.5f) / 512.f * kPi);
        const glm::vec3 radiance = glm::mix(horizon, sine > 0 ? zenith : nadir, std::abs(sine));
        for (int x = 0; x < 4; ++x)
            std::copy_n(&radiance.x, 3, environment.remainder.at(x, y));
    }
    environment.description = "gradient from nadir over the horizon to the zenith";
    return environment;
}

} // namespace kokage
