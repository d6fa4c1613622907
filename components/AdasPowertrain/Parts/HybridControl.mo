within AdasPowertrain.Parts;
model HybridControl
  "Energy management of a P2 hybrid by rules with a band of the state of charge: Onori, Serrao, Rizzoni, Hybrid Electric
   Vehicles: Energy Management Strategies, 2016, ch. 4. The engine runs when much power is wanted or the battery is low.
   It carries the mean demand and what the battery should be charged with"
  extends HybridManagement;
  parameter Real start_power(unit="W", min=0, max=200000) = 15000 "Of the wheels; the engine starts above";
  parameter Real stop_power(unit="W", min=0, max=200000) = 6000 "Of the wheels; the engine stops below";
  parameter Real low_soc(min=0, max=1) = 0.45 "The engine runs below";
  parameter Real high_soc(min=0, max=1) = 0.55 "Until here, once it runs to charge";
  parameter Real charging_gain(unit="W", min=0, max=1e6) = 100000 "Charging power per state of charge missing";
  parameter Real max_charging(unit="W", min=0, max=100000) = 8000 "Charging power by the engine";
  parameter Real max_engine_torque(unit="N.m", min=10, max=600) = 200 "Asked of the engine at most";
protected
  Real power(unit="W") "Wanted";
  Real charging(unit="W") "Asked of the engine for the battery";
  Boolean is_low(start=false, fixed=true) "Battery";
  Boolean is_demanding(start=false, fixed=true) "Driver";
equation
  power = shaft_torque * machine_speed;
  is_low = soc < low_soc or pre(is_low) and soc < high_soc;
  is_demanding = power > start_power or pre(is_demanding) and power > stop_power;
  is_wanted = is_low or is_demanding;
  is_urgent = false;
  charging = noEvent(max(-max_charging, min(max_charging, charging_gain * (target_soc - soc))));
  best = noEvent(max(least_engine_torque, min(min(max_engine_torque, shaft_torque - request.lowest), shaft_torque + charging / max(machine_speed, stop_speed))));
end HybridControl;
