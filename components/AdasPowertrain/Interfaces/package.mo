within AdasPowertrain;
package Interfaces "Connectors and what alternatives share"
end Interfaces;
