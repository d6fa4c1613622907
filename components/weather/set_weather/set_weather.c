#include "set_weather.h"

#include <math.h>

#define GAS_CONSTANT 287.05287 /* J/(kg K), of dry air */
#define TURN 6.283185307179586
#define FREEZING 273.15 /* K */
#define MM_PER_HOUR 3.6e6 /* in 1 m/s */

/* m; on a wet road at least the standing film. */
static double water_film(const set_weather *self) {
    double standing = self->par.road == SET_WEATHER_WET ? self->par.standing_film : 0;
    if (!(self->par.rain_rate > 0)) return standing;
    double rate = self->par.rain_rate * MM_PER_HOUR, fall = fmax(self->par.drainage_fall, 1e-3);
    double film = 1e-3 * 0.046 * sqrt(self->par.drainage_length * rate) / pow(fall, 0.2);
    return fmax(film, standing);
}

static double covered(double loss, double layer, double critical) {
    return layer > 0 ? loss * (1 - pow(0.25, layer / critical)) : 0;
}

static double friction_loss(const set_weather *self, double film) {
    double lying = covered(self->par.snow_loss, self->lying, self->par.critical_snow);
    if (self->par.road == SET_WEATHER_ICE) return fmax(self->par.ice_loss, lying);
    if (self->par.road == SET_WEATHER_SNOW) return self->par.snow_loss;
    return fmax(covered(self->par.wet_loss, film, self->par.critical_film), lying);
}

/* A sum of steps: rates and temperature may change. */
static void snow(set_weather *self, double h) {
    double melting = self->par.melting * fmax(self->par.temperature - FREEZING, 0);
    self->lying = fmax(self->lying + h * (self->par.snow_rate - melting), 0);
}

static double wind(const set_weather *self) {
    double since = counted_time_now(&self->time) - self->par.gust_start;
    if (self->par.gust_period > 0 && since > 0) since -= self->par.gust_period * floor(since / self->par.gust_period);
    if (!(since > 0 && since < self->par.gust_duration)) return self->par.wind_speed;
    return self->par.wind_speed + 0.5 * self->par.gust_speed * (1 - cos(TURN * since / self->par.gust_duration));
}

static void output(set_weather *self) {
    double speed = wind(self), film = water_film(self);
    self->out.air.density = self->par.pressure / (GAS_CONSTANT * self->par.temperature);
    self->out.air.wind_x = speed * cos(self->par.wind_direction);
    self->out.air.wind_y = speed * sin(self->par.wind_direction);
    self->out.visibility.rain_rate = self->par.rain_rate;
    self->out.visibility.snow_rate = self->par.snow_rate;
    self->out.visibility.fog_extinction = self->par.fog_visibility > 0 ? -log(0.05) / self->par.fog_visibility : 0;
    self->out.visibility.darkness = self->par.darkness;
    self->out.sun.azimuth = self->par.sun_azimuth;
    self->out.sun.elevation = self->par.sun_elevation;
    self->out.sun.glare = self->par.sun_glare;
    self->out.surface.friction_loss = friction_loss(self, film);
    self->out.surface.water_film = film;
    self->out.surface.temperature = self->par.temperature;
}

void set_weather_init(set_weather *self) {
    counted_time start = {0, 0, 0};
    self->time = start;
    self->lying = self->par.lying_snow;
    output(self);
}

void set_weather_step(set_weather *self, double h) {
    counted_time_advance(&self->time, h);
    snow(self, h);
    output(self);
}
