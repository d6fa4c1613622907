/* Outputs of the weather components. */
#ifndef WEATHER_H
#define WEATHER_H

typedef struct {
    struct {
        double density, wind_x, wind_y;
    } air;
    struct {
        double rain_rate, snow_rate, fog_extinction, darkness;
    } visibility;
    struct {
        double azimuth, elevation, glare;
    } sun;
    struct {
        double friction_loss, water_film, temperature;
    } surface;
} weather_out;

#endif
