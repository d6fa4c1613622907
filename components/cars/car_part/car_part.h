/* A passive part of a car: mass, inertia, drag and other constants, passed on to the parts that use them.
 * Its interface defines which of them a part has. */
#ifndef CAR_PART_H
#define CAR_PART_H

typedef struct {
    double front, rear;
} car_part_axles;

typedef struct {
    double radius, grip, stiffness, rolling_resistance;
} car_part_tyre;

typedef struct {
    double ratio, efficiency, mass;
} car_part_gear;

typedef struct {
    double max_current, standby_power, loss, mass;
} car_part_inverter;

typedef struct {
    struct {
        car_part_axles load, inertia;
        double drag_area, power;
        car_part_tyre tyre;
        car_part_gear gear;
        car_part_inverter inverter;
    } out;
    struct {
        double mass, front_share; /* kg; share of the mass on the front axle, beyond 0 … 1 for an overhang */
        double wheel_inertia;     /* kg.m2: of one of four alike */
        double drag, draw; /* m2, W */
        double radius, grip, stiffness, rolling_resistance;
        double ratio, efficiency;
        double max_current, standby_power, loss;
    } par;
} car_part;

void car_part_init(car_part *self);
void car_part_step(car_part *self, double h);

#endif
