within Tiny.Interfaces;
connector RealOutput = output Real "'output Real' as connector";
