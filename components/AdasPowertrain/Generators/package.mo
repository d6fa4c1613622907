within AdasPowertrain;
package Generators "Engines with generators, without a path to the wheels"
end Generators;
