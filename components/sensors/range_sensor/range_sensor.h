/* Range sensor on the world's rays: range, field of view, latency and seeded noise; sampled.
 *
 * Weather shortens the range. Rain and snow of r mm/h (of water) take loss * r^exponent dB from each km, one way, as
 * ITU-R has it: at 77 GHz and horizontal polarization 1.132 r^0.718 (P.838-3, from its equations), in visible and
 * near infrared light 1.076 r^0.67 for rain and (0.0001023 w + 3.7855) r^0.72 for wet snow, w the wavelength in nm
 * (P.1814). Fog droplets are larger than the wavelength of light: all of the visible extinction affects lidar and
 * camera (Kim, McArthur, Korevaar, SPIE 4214, 2001), none of it affects radar.
 * An echo that falls with R^n in clear air (radar equation: 4 for a point, 2 for a target that fills the beam) then
 * falls with R^n exp(2 a R): it is as strong as that of max_range in clear air at the R with
 *   R exp(2 a R / n) = max_range.
 * A camera (n = 0) sees by contrast, which falls with exp(-a R) (Koschmieder): up to R = -ln(contrast) / a. In the dark
 * its range is that of the headlamps: low beams show an object of little contrast 45 m to 90 m ahead (Perel, Olson,
 * Sivak, Medlin, SAE 830567, 1983).
 */
#ifndef RANGE_SENSOR_H
#define RANGE_SENSOR_H

#include <stdbool.h>
#include <stdint.h>

#define RANGE_SENSOR_LATENCY 15 /* longest latency, in samples */

typedef struct {
    double gap, closing_speed;
    bool detected;
} range_sensor_target;

typedef struct {
    struct {
        struct {
            double range, azimuth, closing_speed;
            bool hit;
        } scene;
        struct {
            double rain_rate, snow_rate, fog_extinction, darkness;
        } visibility;
    } in;
    struct {
        range_sensor_target target;
    } out;
    struct {
        double max_range, field_of_view;      /* m; rad, from edge to edge */
        double gap_noise, closing_speed_noise; /* standard deviations */
        int32_t latency;                       /* samples */
        int32_t seed;
        double rain_loss, rain_exponent, snow_loss, snow_exponent; /* dB/km at 1 mm/h */
        double fog_share;                                          /* of the extinction of visible light */
        double echo_exponent;                                      /* n; 0: sees by contrast */
        double contrast;                                           /* the least visible, relative to black on white */
        double night_range;                                        /* m; 0: sees by night as by day */
    } par;
    range_sensor_target samples[RANGE_SENSOR_LATENCY + 1];
    int32_t newest;
    uint64_t random;
} range_sensor;

void range_sensor_init(range_sensor *self);
void range_sensor_step(range_sensor *self);

#endif
