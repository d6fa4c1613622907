/* Weather by its numbers, with published relations to the quantities that tyres, cars and sensors use.
 *
 * Water film d (mm) on the path that the water drains along (m), with rain R (mm/h) and fall S (Ross and Russam, "The
 *   depth of rain water on road surfaces", RRL report LR 236, 1968):  d = 0.046 (L R)^(1/2) S^(-1/5)
 * Friction on a wet road relative to a dry one: 1 - loss (1 - 0.25^(d / d75)), which falls already with thin films;
 * d75, where three quarters of it are lost, is within 0.025 and 0.23 mm (Kulakowski and Harwood, ASTM STP 1031, 1990).
 * Losses from the peak coefficients of road adhesion in Wong, "Theory of ground vehicles", 3rd edition, table 1.3
 *   (from Taborek 1957): asphalt dry 0.85, wet 0.6, hard-packed snow 0.2, ice 0.1; so 0.29, 0.76 and 0.88.
 * Falling snow settles; above the freezing point T0 it melts by a degree-day factor f, as in hydrology (Hock, J. Hydrology
 *   282:104, 2003):  dw/dt = snow rate - f max(T - T0, 0),  w >= 0 in m of water. Traffic and wind remove none. Friction
 *   falls with it as with a film of water, 1 - loss (1 - 0.25^(w / w75)), w75 assumed; the larger loss of both counts.
 * Density of dry air: p / (287.05 J/(kg K) T) (ISO 2533).
 * Fog: extinction -ln(0.05) / V, V the visibility at a contrast of 5 % (Koschmieder 1924; WMO-No. 8, meteorological
 *   optical range). Rain and snow are added by each sensor, which sees them in its own way.
 * Gust: 1/2 U (1 - cos(2 pi (t - t0) / T)) from t0 on, for T (the "1-cosine" gust of IEC 61400-1 and CS 25.341).
 */
#ifndef SET_WEATHER_H
#define SET_WEATHER_H

#include <stdbool.h>
#include <stdint.h>

#include "../../traffic/profile/speed_profile.h"
#include "../clear/weather.h"

typedef enum { SET_WEATHER_DRY, SET_WEATHER_WET, SET_WEATHER_SNOW, SET_WEATHER_ICE } set_weather_road;

typedef struct {
    weather_out out;
    struct {
        double rain_rate, snow_rate, fog_visibility, darkness, sun_azimuth, sun_elevation, sun_glare, temperature, pressure;
        int32_t road;
        double drainage_length, drainage_fall, standing_film, critical_film;
        double wet_loss, snow_loss, ice_loss, lying_snow, critical_snow, melting;
        double wind_speed, wind_direction, gust_speed, gust_start, gust_duration, gust_period;
    } par;
    counted_time time;
    double lying; /* m of water */
} set_weather;

void set_weather_init(set_weather *self);
void set_weather_step(set_weather *self, double h);

#endif
