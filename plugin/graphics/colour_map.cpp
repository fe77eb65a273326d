#include "plugin/graphics/colour_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

// The energy map is a path through OKLab at constant speed, which makes it perceptually uniform (decision 0172).

namespace supercircle::graphics {

namespace {

struct Lab {
    double L = 0.0, a = 0.0, b = 0.0;
};

double toLinear(double c) {
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}
double fromLinear(double c) {
    return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1.0 / 2.4) - 0.055;
}

Lab toLab(const Colour& colour) {
    const double r = toLinear(colour.r), g = toLinear(colour.g), b = toLinear(colour.b);
    const double l = std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
    const double m = std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
    const double s = std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
    return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
            1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
            0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

Colour toColour(const Lab& lab) {
    const auto cube = [](double x) { return x * x * x; };
    const double l = cube(lab.L + 0.3963377774 * lab.a + 0.2158037573 * lab.b);
    const double m = cube(lab.L - 0.1055613458 * lab.a - 0.0638541728 * lab.b);
    const double s = cube(lab.L - 0.0894841775 * lab.a - 1.2914855480 * lab.b);
    const auto channel = [](double x) { return std::clamp(fromLinear(std::max(x, 0.0)), 0.0, 1.0); };
    return {channel(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
            channel(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
            channel(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)};
}

double distance(const Lab& p, const Lab& q) {
    return std::hypot(p.L - q.L, p.a - q.a, p.b - q.b);
}

/// The path before equal spacing: lightness falls linearly while the hue turns from blue over violet to red.
Lab rawPath(double t) {
    static constexpr std::array<std::array<double, 3>, 6> anchors{{
        // L, chroma, hue in degrees; chroma kept inside sRGB
        {0.800, 0.085, 225.0},
        {0.710, 0.115, 258.0},
        {0.620, 0.150, 296.0},
        {0.530, 0.180, 335.0},
        {0.440, 0.165, 370.0},
        {0.350, 0.135, 388.0},
    }};
    const double position = std::clamp(t, 0.0, 1.0) * (anchors.size() - 1);
    const auto i = std::min(static_cast<std::size_t>(position), anchors.size() - 2);
    const double w = position - static_cast<double>(i);
    const auto mix = [&](std::size_t k) { return (1.0 - w) * anchors[i][k] + w * anchors[i + 1][k]; };
    const double hue = mix(2) * std::numbers::pi / 180.0;
    return {mix(0), mix(1) * std::cos(hue), mix(1) * std::sin(hue)};
}

constexpr int samples = 512;

/// Parameters of the raw path at equal arc lengths.
std::array<double, samples + 1> evenSpeed() {
    std::array<double, samples + 1> length{}, even{};
    for (int i = 1; i <= samples; ++i)
        length[i] = length[i - 1] + distance(rawPath((i - 1.0) / samples), rawPath(double(i) / samples));
    int k = 0;
    for (int i = 0; i <= samples; ++i) {
        const double wanted = length[samples] * i / samples;
        while (k < samples - 1 && length[k + 1] < wanted)
            ++k;
        even[i] = (k + (wanted - length[k]) / (length[k + 1] - length[k])) / samples;
    }
    return even;
}

} // namespace

Colour energyColour(double t) {
    if (std::isnan(t))
        return Colour::hex(0x9aa0a6);
    static const auto table = evenSpeed();
    const double position = std::clamp(t, 0.0, 1.0) * samples;
    const int i = std::min(static_cast<int>(position), samples - 1);
    const double w = position - i;
    return toColour(rawPath((1.0 - w) * table[i] + w * table[i + 1]));
}

Colour signedColour(double t) {
    if (std::isnan(t))
        return Colour::hex(0x9aa0a6);
    t = std::clamp(t, -1.0, 1.0);
    const double size = std::abs(t);
    const double hue = (t < 0.0 ? 255.0 : 28.0) * std::numbers::pi / 180.0;
    const double chroma = 0.15 * size;
    return toColour({0.78 - 0.30 * size, chroma * std::cos(hue), chroma * std::sin(hue)});
}

double lightness(const Colour& colour) {
    return toLab(colour).L;
}

double colourDistance(const Colour& a, const Colour& b) {
    return distance(toLab(a), toLab(b));
}

} // namespace supercircle::graphics
