# A car that a bench pushes with a force, 20 m from a wall. It answers place, speed and gap.
# dse udp check 127.0.0.1:5005 --out 1 --back 3 --step 0.01
extends "res://dse/dse_world.gd"

const DseFrame = preload("res://dse/dse_frame.gd")
const MASS = 1200.0
const WALL = 20.0

var place = 0.0
var speed = 0.0


func _init():
	asked = 1
	answered = 3


func begin():
	place = 0.0
	speed = 0.0
	if has_node("Movers"):
		get_node("Movers").put(0, 6, Vector3(8.0, 1.5, 0.4), WALL + 2.45, 0.0, 0.0, 0.0)


func advance(values, seconds):
	place += 0.5 * seconds * speed
	speed += seconds * values[0] / MASS
	place += 0.5 * seconds * speed
	if has_node("Car"):
		get_node("Car").transform.origin = DseFrame.position(place, 0.0, 0.0)


func read():
	return [place, speed, WALL - place]
