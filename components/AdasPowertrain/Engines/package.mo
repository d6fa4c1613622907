within AdasPowertrain;
package Engines "Combustion engines"
end Engines;
