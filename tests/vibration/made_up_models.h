// A file of vibration models, in the form of the Penn Haptic Texture Toolkit.
#pragma once

#include <string>

#include <fmt/format.h>

namespace forceshade::testing {

/// Three models alike: noise of 4 (m/s^2)^2 through a filter of second order; a friction coefficient of 0.45.
inline std::string made_up_models() {
    std::string text =
        "<modelSet><material>Made "
        "up</material><AccelUnits>m/s^2</AccelUnits><SpeedUnits>mm/s</SpeedUnits><ForceUnits>N</"
        "ForceUnits><SampleRate>1000</SampleRate><mu>0.45</mu><maxSpeed>200</maxSpeed><maxForce>4</"
        "maxForce><speedList><value>0</value><value>400</value><value>0</value></speedList><forceList><value>0</"
        "value><value>0</value><value>8</value></forceList><tri><value>1</value><value>2</value><value>3</value></tri>";
    for (int model = 1; model <= 3; ++model)
        text += fmt::format(
            "<model><modNum>{}</modNum><ARlsf><value>0.8</value><value>1.9</value></ARlsf><var>4</var></model>", model);
    return text + "</modelSet>";
}

} // namespace forceshade::testing
