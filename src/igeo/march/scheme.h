/// The two schemes for the distance.
#pragma once

namespace igeo {

enum class Scheme {
    Jet,     ///< value and gradient on foot points, second order (jet.h)
    Godunov  ///< Fast Marching in the band, Mémoli & Sapiro 2001 (godunov.h)
};

/// "jet" or "godunov".
constexpr const char* toString(Scheme scheme) { return scheme == Scheme::Jet ? "jet" : "godunov"; }

}  // namespace igeo
