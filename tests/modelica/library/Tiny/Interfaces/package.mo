within Tiny;
package Interfaces "Connectors and partial models"
end Interfaces;
