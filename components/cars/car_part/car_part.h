/* A part of a car that only is there: mass, inertia, drag and other constants, passed on to the parts that reckon with them.
 * Which of them a part has is said by its interface. */
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
        double mass, front_share; /* kg; of the mass on the front axle, beyond 0 … 1 for what hangs over */
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
