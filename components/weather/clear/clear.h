/* A dry, still day. */
#ifndef CLEAR_H
#define CLEAR_H

#include "weather.h"

typedef struct {
    weather_out out;
    struct {
        double temperature, density;
    } par;
} clear;

void clear_init(clear *self);
void clear_step(clear *self, double h);

#endif
