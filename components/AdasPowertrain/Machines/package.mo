within AdasPowertrain;
package Machines "Electric machines"
end Machines;
