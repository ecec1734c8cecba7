; Boxes that a hand picks from and places on supports and other boxes.
;
; No action changes upright or tipped: a box that lies on its side is carried lying and laid down lying.
; clear is about boxes only: nothing rests on the box, and it is not held. A support always has room for more, and so has
; a region of it. A pose has room for one box.

(define (domain boxes)
  (:requirements :strips :typing :equality :negative-preconditions :disjunctive-preconditions
    :quantified-preconditions :conditional-effects)

  (:types box support - thing region pose - support)

  (:predicates
    (on ?a - box ?b - thing)       ; a stands upright on b
    (lying ?a - box ?b - thing)    ; a rests on b, tipped over onto its side
    (in-hand ?a - box)
    (clear ?a - box)
    (hand-empty)
    (upright ?a - box)
    (tipped ?a - box))

  (:action pick
    :parameters (?a - box ?b - thing)
    :precondition (and
      (hand-empty)
      (clear ?a)
      (not (= ?a ?b))
      (or (and (upright ?a) (on ?a ?b)) (and (tipped ?a) (lying ?a ?b))))
    :effect (and
      (in-hand ?a)
      (not (hand-empty))
      (not (clear ?a))
      (when (upright ?a) (not (on ?a ?b)))
      (when (tipped ?a) (not (lying ?a ?b)))
      (forall (?x - box) (when (= ?x ?b) (clear ?x)))))

  (:action place
    :parameters (?a - box ?b - thing)
    :precondition (and
      (in-hand ?a)
      (not (= ?a ?b))
      (forall (?x - box) (imply (= ?x ?b) (clear ?x)))
      (forall (?x - pose) (imply (= ?x ?b) (not (exists (?y - box) (or (on ?y ?x) (lying ?y ?x)))))))
    :effect (and
      (hand-empty)
      (clear ?a)
      (not (in-hand ?a))
      (when (upright ?a) (on ?a ?b))
      (when (tipped ?a) (lying ?a ?b))
      (forall (?x - box) (when (= ?x ?b) (not (clear ?x)))))))
