within AdasPowertrain.Driveline;
model Differential "Final drive; both wheels of the axle turn alike and are one flange"
  extends Interfaces.TwoFlanges;
  parameter Real ratio(min = 0) "Turns of a per turn of b";
equation
  a.phi = ratio*b.phi;
  ratio*a.tau + b.tau = 0;
end Differential;
