within AdasPowertrain;
package Smooth "Limits without corners, so that a solver need not search for them"
end Smooth;
