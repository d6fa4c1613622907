"""CO2 of six cars on the dynamometer against their certificates: the table of docs/powertrains.md.

`python benchmarks/certificates.py CARS CYCLES`. CARS is a folder with the Test Car List Data of the EPA for the model
years 2014 to 2016 (`14tstcar.csv` …, https://www.epa.gov/compliance-and-fuel-economy-data), CYCLES one with the cycles
`udds` and `hwfet` as two columns of seconds and miles per hour, any suffix. Neither is part of dse.

From the certificate: equivalent test weight, target coefficients of the road load, displacement, speed of the engine
per speed of the car in the top gear. All else is the library's: nothing is fitted. Highway (HWFET): warm. City (FTP):
the UDDS from 23 degrees Celsius, then its first 505 s warm, weighted by 0.43 and 0.57 (40 CFR 600).
"""

from __future__ import annotations

import argparse
import csv
import tempfile
from pathlib import Path

import numpy as np
from fmpy import simulate_fmu
from numpy.typing import NDArray

from dse.domain.component import NO_INTERFACE, Component, ModelicaSource
from dse.fmu.component_build import build

ROOT = Path(__file__).parents[1]
MILE, POUND, POUND_FORCE, RADIUS = 1609.344, 0.45359237, 4.4482216, 0.31
CARS = (  # name, test vehicle, model year, target coefficient A, gearbox
    ("Chevrolet Malibu 1.5", "151GZV4311", 2016, 26.28, "Automatic"),
    ("Ford Fusion 1.5", "ER100011", 2014, 19.84, "Automatic"),
    ("Volkswagen Jetta 1.4", "VW361-6-0106", 2016, 23.16, "Automatic"),
    ("Chevrolet Cruze 1.4", "143687P071", 2016, 26.42, "Automatic"),
    ("Hyundai Sonata 1.6", "LF5R6HU09B2", 2015, 35.626, "DualClutch"),
    ("Kia Optima 1.6", "JF6R6TU01AC", 2016, 27.883, "DualClutch"),
)
TOP_GEAR = {"Automatic": 0.686, "DualClutch": 0.5781}
HIGHWAY, CITY = {3}, {2, 21, 31}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("cars", type=Path)
    parser.add_argument("cycles", type=Path)
    given = parser.parse_args()
    udds, hwfet = (_cycle(next(given.cycles.glob(f"{name}*"))) for name in ("udds", "hwfet"))
    print(
        "| car | kg | highway, g/km | certificate | | city, g/km | certificate | "
        "| cold transient | stabilized | hot transient |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|"
    )
    with tempfile.TemporaryDirectory() as cache:
        for name, vehicle, year, coefficient, gearbox in CARS:
            tests = _tests(given.cars / f"{year % 100}tstcar.csv", vehicle, coefficient)
            car = Component(
                gearbox, NO_INTERFACE,
                source=ModelicaSource(
                    f"Dynamometer.{gearbox}", (ROOT / "benchmarks/Dynamometer.mo", ROOT / "components/AdasPowertrain")
                ),
            )  # fmt: skip
            fmu, start = build(car, cache=Path(cache)), _parameters(tests[0], TOP_GEAR[gearbox])
            highway = _drive(fmu, hwfet, start, 363.15)[-1]
            cold, warm = _drive(fmu, udds, start, 296.15), _drive(fmu, udds[:506], start, 360.0)[-1]
            city = 0.43 * _rate(cold[-1]) + 0.57 * _rate(warm + cold[-1] - cold[505])
            cells = [name, f"{start['mass']:.0f}"]
            for found, kinds in ((_rate(highway), HIGHWAY), (city, CITY)):
                stated = np.mean([_number(test, "CO2 (g/mi)") for test in tests if _kind(test) in kinds]) / 1.609344
                cells += [f"{found:.0f}", f"{stated:.0f}", f"{found / stated - 1:+.1%}"]
            bags = (_rate(cold[505]), _rate(cold[-1] - cold[505]), _rate(warm))
            print("|", " | ".join([*cells, *_by_bag(bags, tests)]), "|", flush=True)


def _by_bag(found: tuple[float, ...], tests: list[dict[str, str]]) -> list[str]:
    """How the three parts of the city test deviate, by their fuel economy: 8887 g of CO2 per gallon (EPA)."""
    stated = [[float(test[f"FE Bag {k}"]) for test in tests if test[f"FE Bag {k}"]] for k in (1, 2, 3)]
    return [
        f"{rate * np.mean(economies) * MILE / 1000 / 8887 - 1:+.1%}" if economies else "–"
        for rate, economies in zip(found, stated, strict=True)
    ]


def _cycle(file: Path) -> NDArray[np.float64]:
    """Speeds in m/s, one a second; lines that are not two numbers are headings."""
    speeds = []
    for line in file.read_text(encoding="utf-8-sig").replace(",", " ").splitlines():
        try:
            _, speed = map(float, line.split())
        except ValueError:
            continue
        speeds.append(speed * MILE / 3600)
    return np.array(speeds)[:1372]


def _tests(file: Path, vehicle: str, coefficient: float) -> list[dict[str, str]]:
    """Those that were driven, not derived, of one vehicle with one road load."""
    with file.open(encoding="latin-1", newline="") as rows:
        return [
            row
            for row in csv.DictReader(rows)
            if row["Test Vehicle ID"].strip() == vehicle
            and row["Analytically Derived FE?"].startswith("N")
            and abs(_number(row, "Target Coef A (lbf)") - coefficient) < 1e-6
            and _kind(row) in HIGHWAY | CITY
        ]


def _parameters(test: dict[str, str], top_gear: float) -> dict[str, float]:
    per_speed = POUND_FORCE / (MILE / 3600)
    turns = _number(test, "N/V Ratio") * 2 * np.pi / 60 / (MILE / 3600)
    return {
        "mass": _number(test, "Equivalent Test Weight (lbs.)") * POUND,
        "f0": _number(test, "Target Coef A (lbf)") * POUND_FORCE,
        "f1": _number(test, "Target Coef B (lbf/mph)") * per_speed,
        "f2": _number(test, "Target Coef C (lbf/mph**2)") * per_speed / (MILE / 3600),
        "powertrain.engine_scale": _number(test, "Test Veh Displacement (L)") / 1.498,
        "powertrain.final_ratio": turns * RADIUS / top_gear,
    }


def _drive(fmu: Path, speeds: NDArray[np.float64], start: dict[str, float], kelvin: float) -> NDArray[np.float64]:
    """Metres and kg of CO2 every second; within 1 m/s of the cycle."""
    times = np.arange(0, len(speeds) - 1 + 1e-9, 0.1)
    seconds = np.arange(len(speeds))
    ahead = np.append(np.diff(speeds), 0.0)[np.minimum(times.astype(int), len(speeds) - 1)]
    series = np.zeros(len(times), [(name, np.float64) for name in ("time", "target", "acceleration")])
    series["time"], series["target"], series["acceleration"] = times, np.interp(times, seconds, speeds), ahead
    found = simulate_fmu(
        str(fmu), stop_time=times[-1], output_interval=0.1, input=series, relative_tolerance=1e-6,
        start_values={**start, "powertrain.initial_temperature": kelvin},
        output=["speed", "distance", "carbon_dioxide"],
    )  # fmt: skip
    rows = found[::10]
    if np.abs(rows["speed"] - speeds).max() > 1:
        raise SystemExit("the car does not follow the cycle")
    return np.column_stack([rows["distance"], rows["carbon_dioxide"]])


def _rate(way: NDArray[np.float64]) -> float:
    """Grams per km."""
    return float(way[1] * 1e6 / way[0])


def _number(test: dict[str, str], column: str) -> float:
    return float(test[column] or "nan")


def _kind(test: dict[str, str]) -> int:
    return int(test["Test Procedure Cd"])


if __name__ == "__main__":
    main()
