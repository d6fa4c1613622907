within AdasPowertrain;
package Driveline "Shafts, differential and inertias"
end Driveline;
