# Places and angles, and road users with a template and without.
extends SceneTree

const DseFrame = preload("res://dse/dse_frame.gd")


func _init():
	print(DseFrame.position(3.0, 4.0, 5.0))
	for heading in [-3.0, 0.3, 1.5]:
		var node = Spatial.new()
		node.rotation = DseFrame.rotation(heading, 0.1, 0.2)
		var forward = -node.transform.basis.z
		var left = -node.transform.basis.x
		print(abs(DseFrame.heading(forward) - heading) < 1e-6, forward.y < -0.09, left.y > 0.1)
	var movers = load("res://dse/dse_movers.gd").new()
	for name in ["box", "truck"]:
		var template = Spatial.new()
		template.name = name
		movers.add_child(template)
	movers._enter_tree()
	for kind in [1, 2, 0]:
		movers.put(4, kind, Vector3(1.8, 1.5, 4.5), 11.0, 2.0, 1.0, 0.0)
		var shown = movers.get_child(movers.get_child_count() - 1)
		print(shown.transform.origin, shown.scale, shown.visible, movers._shown.size())
	quit()
