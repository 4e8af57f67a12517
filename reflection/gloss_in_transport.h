#pragma once
// Gloss in a transport that knows even scattering alone: what patches mirror goes on as if they scattered it evenly,
// and is taken out again where gloss is drawn by itself.
#include "reflection/picture.h"

namespace kokage {

/// The optics of every patch's kind with its gloss: reflectance + k (gloss.h), so that what leaves mirror lights other
/// leaves (a tenth of the light inside a crown under the sun). For Transport::set_optics. Without gloss: as they are.
std::vector<Optics> optics_with_gloss(const ShadedScene& scene);

/// From indirect radiance solved with these optics to what is scattered without gloss: both irradiances follow from
/// both radiances (B+ = (rho E+ + tau E-) / pi, B- = (rho E- + tau E+) / pi). Where rho and tau are too near each other
/// to tell the sides apart, their difference shrinks as their sum does. `radiance_front` and `_back` stay: they are
/// what others see, and what pictures without per-pixel shadows show, which therefore draw no gloss.
void take_gloss_out(const std::vector<Optics>& with_gloss, ShadedScene& scene);

} // namespace kokage
