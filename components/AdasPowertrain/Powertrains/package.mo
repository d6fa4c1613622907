within AdasPowertrain;
package Powertrains "Complete powertrains: from torque demand to the torques of both axles"
end Powertrains;
