/* Shared by cruise controllers: ports, the wanted gap, and the conversion from an acceleration to torques. */
#ifndef ACC_H
#define ACC_H

#include <stdbool.h>
#include <stdint.h>

#define ACC_STEP 0.01 /* s; the step in the component.yaml of every controller */

enum { ACC_MODE_SPEED, ACC_MODE_DISTANCE };
enum { ACC_GAP_FIXED, ACC_GAP_LONG, ACC_GAP_MIDDLE, ACC_GAP_SHORT };

typedef struct {
    struct {
        double gap, closing_speed;
        bool detected;
    } target;
    double speed, set_speed, set_gap;
} acc_in;

typedef struct {
    struct {
        double drive_torque, brake_torque;
    } demand;
    int32_t mode;
    struct {
        double speed, gap;
    } reference;
} acc_out;

/* The car as the controller assumes it. */
typedef struct {
    double mass, wheel_radius, drag_area, rolling_resistance;
} acc_car;

/* s: of long, middle and short; 0 of a fixed gap. */
double acc_time_gap(int32_t setting);

/* Gap the driver wants: set_gap, or standstill gap + time gap * speed for long, middle and short. */
double acc_wanted_gap(int32_t setting, double standstill_gap, const acc_in *in);

/* Totals at the wheels that give the acceleration on a level road: road load fed forward, never drive and brake. */
void acc_demand(const acc_car *car, double acceleration, const acc_in *in, acc_out *out);

/* Target values of the active mode: the set speed, or the speed of the vehicle in front. */
void acc_report(int32_t mode, double wanted_gap, const acc_in *in, acc_out *out);

double acc_limit(double value, double low, double high);

#endif
