/* Arbitrates between driver and assistants. Along the road the states are those of ISO 15622: the cruise control is off
 * (manual), on standby, or active (cruise). The accelerator overrides it and leaves it active; the brake puts it on
 * standby until it is switched on again. When it is switched off while braking, its brake is released with a limited
 * rate. Across, hands on the wheel override lane keeping (UN R79, 5.6.2: the driver can override at any time). The
 * emergency brake has priority, behind the arbiter; here it ends cruising. */
#ifndef DRIVER_CONTROLS_H
#define DRIVER_CONTROLS_H

#include <stdbool.h>
#include <stdint.h>

#define CONTROLS_STEP 0.01 /* s; the step in the component.yaml */

enum { CONTROLS_MANUAL, CONTROLS_STANDBY, CONTROLS_CRUISE, CONTROLS_OVERRIDE, CONTROLS_EMERGENCY };
enum { CONTROLS_BY_DRIVER, CONTROLS_BY_LANE_KEEPING };
enum { CONTROLS_STAGE_PARTIAL = 2 };

typedef struct {
    struct {
        struct {
            double accelerator, brake, steering;
            bool hands_on, cruise;
            double set_speed;
        } driver;
        struct {
            double drive_torque, brake_torque;
        } cruise_demand;
        double lane_steering, speed;
        int32_t stage;
    } in;
    struct {
        struct {
            double drive_torque, brake_torque;
        } demand;
        double steering, set_speed;
        int32_t mode, steered_by;
    } out;
    struct {
        double max_drive_torque, max_drive_power, max_deceleration;
        double overrun, hold_torque, brake_touch, release_rate, set_speed_rate;
        double max_steering, hand_rate, return_rate, max_lateral_acceleration;
        double nominal_mass, wheel_radius, wheelbase;
    } par;
    bool was_cruise, is_active;
    double released; /* N.m: what remains of the cruise control's brake after it was switched off */
    double hand;     /* rad: the wheel in the driver's hands, as angle of the front wheels at walking speed */
    bool is_returning;
} driver_controls;

void driver_controls_init(driver_controls *self);
void driver_controls_step(driver_controls *self);

#endif
