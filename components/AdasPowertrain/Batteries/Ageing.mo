within AdasPowertrain.Batteries;
block Ageing
  "Loss of capacity of lithium iron phosphate cells. By cycles: J. Wang et al., Journal of Power Sources 196 (2011), 3942:
   loss in % = B*exp((-31700 + 370.3*C_rate)/(8.314*T))*Ah^0.55, Ah through a cell of 2.2 Ah, B = 31630 at C/2, 21681 at 2C,
   12934 at 6C, 15512 at 10C (15 to 60 degrees Celsius; straight lines between; rates
   beyond these count as 0.5 and 10). By time: M. Naumann et al.,
   Journal of Energy Storage 17 (2018), 153: loss = 1.2571e-5/s^0.5*exp(-17126/8.314*(1/T - 1/298.15))*(2.8575*(soc - 0.5)^3
   + 0.60225)*t^0.5. Both are summed. Integrated are the powers of the losses that grow linearly, so that rate and
   temperature may change (damage adds up along each law). One run can represent many"
  parameter Real capacity(unit="C", min=3600, max=3.6e6) "Of the new battery";
  parameter Real throughput_factor(min=0) = 1 "Charge through the battery counts so many times";
  parameter Real time_factor(min=0) = 1 "Time counts so many times";
  parameter Real initial_cycle_loss(min=0, max=0.5) = 0 "Part of the new capacity that cycles took before";
  parameter Real initial_calendar_loss(min=0, max=0.5) = 0 "Part of the new capacity that time took before";
  input Real temperature(unit="K");
  input Real current(unit="A");
  input Real soc;
  output Real cycle_loss "Part of the new capacity";
  output Real calendar_loss "Part of the new capacity";
  output Real state_of_health "Capacity over that of the new battery";
protected
  constant Real exponent = 0.55;
  constant Real gas(unit="J/(mol.K)") = 8.314;
  constant Real rates[4] = {0.5, 2, 6, 10};
  constant Real factors[4] = {31630, 21681, 12934, 15512};
  constant Real cell_charge = 2.2 "Ah";
  Real rate(unit="1/h") "C-rate";
  Real counted(unit="1/h") "C-rate within the range of the law";
  Real severity "Loss in % of 1 Ah through the cell";
  Real speed(unit="1/s") "Of the squared loss by time";
  Real cycle_damage(start=(100 * initial_cycle_loss) ^ (1 / exponent), fixed=true) "Loss in %, to the power of 1/exponent";
  Real calendar_damage(start=initial_calendar_loss ^ 2, fixed=true) "Loss squared";
equation
  rate = noEvent(abs(current)) * 3600 / capacity;
  counted = noEvent(max(0.5, min(10, rate)));
  severity = Tables.linear1D(counted, rates, factors) * exp((370.3 * counted - 31700) / (gas * temperature));
  der(cycle_damage) = throughput_factor * severity ^ (1 / exponent) * rate * cell_charge / 3600;
  speed = (1.2571e-5 * exp(17126 / gas * (1 / 298.15 - 1 / temperature)) * (2.8575 * (soc - 0.5) ^ 3 + 0.60225)) ^ 2;
  der(calendar_damage) = time_factor * speed;
  cycle_loss = 0.01 * noEvent(max(cycle_damage, 1e-12)) ^ exponent;
  calendar_loss = sqrt(noEvent(max(calendar_damage, 0)));
  state_of_health = 1 - cycle_loss - calendar_loss;
end Ageing;
